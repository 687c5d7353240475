// What becomes of a job at every event: one row of the table below for each event and the states
// that know it. What has no row cannot happen: of a person's request it is refused, and of anything
// else it is a mistake of the program. docs/ARCHITECTURE draws this table, and a test compares
// them.
//
// Which event something is, whoever calls decides (src/daemon/jobs): of a tray that ended whether
// it was the last, of a crash whether anything had been sent. What is said of a printer (its bed is
// clear, it is paused, connected or gone) changes no job; it lets jobs that are approved begin.
#pragma once

#include <array>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string_view>

#include "job/store/job_state.h"

namespace packmerger {

enum class JobEventKind {
  // of its file
  kArrived,
  kUploaded,
  kFileAgain,
  kProgramAgain,
  kTaken,
  kOnAnotherDisk,
  kNotTaken,
  kFileGone,
  // of preparing
  kCompareBegins,
  kPrepareBegins,
  kUnpreparable,
  kHashed,
  kProposed,
  kFitsNowhere,
  kPrepared,
  kPrepareFailed,
  // of people, and of the settings in their place
  kApprove,
  kApproveByItself,
  kApprovedBefore,
  kHold,
  kRelease,
  kPutFirst,
  kPrepareOtherwise,
  kReplace,
  kCancel,
  // of the print
  kTrayBegins,
  kTrayNotBegun,
  kTrayBegunAfterAll,
  kTrayPrinted,
  kLastTrayPrinted,
  kTrayHandedOver,
  kPrintFailed,
  kPrintCancelled,
  // of the daemon
  kStopped,
  kDied,
  kDiedBeforeTheTray,
  kDiedTooOften,
  kOrderExpired,
  kBroken,
  // of its file and folder at the end
  kPlaced,
  kNameTaken,
  kFiled,
  kDelete,
  kDeleted,
};

// What changes in the job's record with an event, beyond the state and what the event tells
// (src/daemon/jobs/job_steps.cpp).
enum class JobAction {
  kNothing,
  kForgetJob,       // its file never left its place
  kCopy,            // its file cannot be renamed to where it belongs
  kCountAttempt,    // a new folder to prepare it in
  kForgetPrepared,  // its approval too
  kForgetDeaths,    // how often in a row the daemon died at it
  kForgetTries,     // to begin the tray
  kApprove,
  kApproveByHand,  // no hold and no order of before any more
  kHold,
  kRelease,
  kReleaseToPrint,  // nor is there an order of before any more
  kBeginTray,
  kNextTray,
  kNoteCancel,  // for the next daemon, should this one die
  kDropOrder,   // to print it at once
  kFile,
  kNoteDelete,  // somebody wants its folder deleted
  kNoteDeleted,
  kEnd,  // its file is filed after it
};

// Any of several states.
class JobStates {
 public:
  constexpr JobStates(std::initializer_list<JobState> states) {
    for (const JobState state : states) bits_ |= bit(state);
  }
  constexpr bool contains(JobState state) const { return (bits_ & bit(state)) != 0; }
  constexpr bool is_empty() const { return bits_ == 0; }

 private:
  static constexpr std::uint32_t bit(JobState state) { return 1U << static_cast<unsigned>(state); }
  std::uint32_t bits_ = 0;
};

struct JobTransition {
  JobStates from;  // empty: the job begins with it
  JobEventKind event;
  std::optional<JobState> to;  // nothing: it stays in its state
  JobAction action = JobAction::kNothing;
};

// clang-format off
inline constexpr auto kJobTransitions = [] {
  using enum JobState;
  using enum JobEventKind;
  using A = JobAction;
  constexpr std::optional<JobState> kStays;
  constexpr JobStates kUnsent = {kClaiming, kReceived, kPreparing, kReady, kApproved};
  constexpr JobStates kUnderWay = {kReceived, kPreparing, kReady, kApproved, kSending};
  constexpr JobStates kEnded = {kDone, kHandedOver, kFailed, kCancelled};
  return std::to_array<JobTransition>({
    // from                                    event               to           action
    {{},                                       kArrived,           kClaiming},
    {{},                                       kUploaded,          kClaiming},
    {{},                                       kFileAgain,         kClaiming},
    {{},                                       kProgramAgain,      kReady},
    {{kClaiming},                              kTaken,             kReceived},
    {{kClaiming},                              kOnAnotherDisk,     kStays,      A::kCopy},
    {{kClaiming},                              kNotTaken,          kStays,      A::kForgetJob},
    {{kClaiming},                              kFileGone,          kFailed,     A::kEnd},
    {{kReceived, kPreparing},                  kCompareBegins,     kPreparing},
    {{kReceived, kPreparing},                  kPrepareBegins,     kPreparing,  A::kCountAttempt},
    {{kReceived, kPreparing},                  kUnpreparable,      kFailed,     A::kEnd},
    {{kPreparing},                             kHashed,            kStays},
    {{kPreparing},                             kProposed,          kStays},
    {{kPreparing},                             kFitsNowhere,       kFailed,     A::kEnd},
    {{kPreparing},                             kPrepared,          kReady,      A::kForgetDeaths},
    {{kPreparing},                             kPrepareFailed,     kFailed,     A::kEnd},
    {{kReady},                                 kApprove,           kApproved,   A::kApproveByHand},
    {{kReady},                                 kApproveByItself,   kApproved,   A::kApprove},
    {{kReady},                                 kApprovedBefore,    kApproved,   A::kApprove},
    {kUnsent,                                  kHold,              kStays,      A::kHold},
    {{kClaiming, kReceived, kPreparing},       kRelease,           kStays,      A::kRelease},
    {{kApproved},                              kRelease,           kStays,      A::kReleaseToPrint},
    {kUnsent,                                  kPutFirst,          kStays},
    {{kReceived, kReady, kApproved},           kPrepareOtherwise,  kReceived,   A::kForgetPrepared},
    {{kReady, kApproved},                      kReplace,           kCancelled,  A::kEnd},
    {{kReceived, kPreparing, kReady, kApproved}, kCancel,          kCancelled,  A::kEnd},
    {{kSending},                               kCancel,            kStays,      A::kNoteCancel},
    {{kApproved},                              kTrayBegins,        kSending,    A::kBeginTray},
    {{kSending},                               kTrayNotBegun,      kApproved,   A::kForgetDeaths},
    {{kSending},                               kTrayBegunAfterAll, kStays,      A::kForgetTries},
    {{kSending},                               kTrayPrinted,       kApproved,   A::kNextTray},
    {{kSending},                               kLastTrayPrinted,   kDone,       A::kEnd},
    {{kSending},                               kTrayHandedOver,    kHandedOver, A::kEnd},
    {{kSending},                               kPrintFailed,       kFailed,     A::kEnd},
    {{kSending},                               kPrintCancelled,    kCancelled,  A::kEnd},
    {{kPreparing},                             kStopped,           kReceived},
    {{kSending},                               kStopped,           kFailed,     A::kEnd},
    {{kPreparing},                             kDied,              kReceived},
    {{kSending},                               kDied,              kFailed,     A::kEnd},
    {{kSending},                               kDiedBeforeTheTray, kApproved},
    {{kPreparing, kSending},                   kDiedTooOften,      kFailed,     A::kEnd},
    {{kClaiming, kReceived, kReady, kApproved}, kOrderExpired,      kStays,      A::kDropOrder},
    {kUnderWay,                                kBroken,            kFailed,     A::kEnd},
    {kEnded,                                   kPlaced,            kStays},
    {kEnded,                                   kNameTaken,         kStays},
    {kEnded,                                   kFiled,             kStays,      A::kFile},
    {kEnded,                                   kDelete,            kStays,      A::kNoteDelete},
    {kEnded,                                   kDeleted,           kStays,      A::kNoteDeleted},
  });
}();
// clang-format on

// Nothing: this state does not know the event, or, without a state, no job begins with it.
const JobTransition* transition_of(std::optional<JobState> from, JobEventKind event);

// As docs/ARCHITECTURE has them: "tray printed", "next tray"; of kNothing "".
std::string_view event_name(JobEventKind event);
std::string_view action_name(JobAction action);

}  // namespace packmerger
