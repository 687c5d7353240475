// The states of a job in the daemon and the steps between them.
//
//   claiming → received → preparing → ready → approved → sending → done
//                                                 ↑___________|    handed_over
//                                             (the next tray)
//
// What is ready or approved can go back to received, to be prepared in another way; so can what is
// being prepared, when the daemon ends.
// From every state that has not ended a job can also become failed or cancelled. `claiming` means
// that its file may still lie in the watched folder; `approved` that it waits for its printer and
// for a clear bed.
#pragma once

#include <optional>
#include <string_view>

namespace packmerger {

enum class JobState {
  kClaiming,
  kReceived,
  kPreparing,
  kReady,
  kApproved,
  kSending,
  kDone,
  kHandedOver,
  kFailed,
  kCancelled
};

// "claiming", "received", … "handed_over": as in the database and in --json.
std::string_view state_name(JobState state);
std::optional<JobState> state_named(std::string_view name);

// Nothing follows these: done, handed_over, failed, cancelled.
bool has_ended(JobState state);

// Whether a job may step from one state to another. Staying in a state is allowed until it ended.
bool may_follow(JobState from, JobState to);

// Whether a job may begin there: claiming (a dropped file), received (prepared again from its
// file), ready (printed again from what was prepared).
bool may_begin(JobState state);

}  // namespace packmerger
