// The states of a job in the daemon; what leads from one to another is the table of
// job_transitions.h.
//
//   claiming → received → preparing → ready → approved → sending → done
//                                                 ↑___________|    handed_over
//                                             (the next tray)
//
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

// Whether a job may step from one state to another: where a row leads there, and from every state
// that has not ended to failed and cancelled. Staying in a state is allowed until it ended.
bool may_follow(JobState from, JobState to);

// Whether a job may begin there: claiming (a dropped file), received (prepared again from its
// file), ready (printed again from what was prepared).
bool may_begin(JobState state);

}  // namespace packmerger
