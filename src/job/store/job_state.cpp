#include "job/store/job_state.h"

#include <array>

namespace packmerger {
namespace {

constexpr std::array<std::string_view, 10> kNames = {
    "claiming", "received", "preparing",   "ready",  "approved",
    "sending",  "done",     "handed_over", "failed", "cancelled"};

}  // namespace

std::string_view state_name(JobState state) { return kNames.at(static_cast<std::size_t>(state)); }

std::optional<JobState> state_named(std::string_view name) {
  for (std::size_t i = 0; i < kNames.size(); ++i)
    if (kNames[i] == name) return static_cast<JobState>(i);
  return std::nullopt;
}

bool has_ended(JobState state) { return state >= JobState::kDone; }

bool may_follow(JobState from, JobState to) {
  if (has_ended(from)) return false;
  if (from == to || to == JobState::kFailed || to == JobState::kCancelled) return true;
  switch (from) {
    case JobState::kClaiming:
      return to == JobState::kReceived;
    case JobState::kReceived:
      return to == JobState::kPreparing;
    case JobState::kPreparing:
      return to == JobState::kReady || to == JobState::kReceived;
    case JobState::kReady:
      return to == JobState::kApproved || to == JobState::kReceived;
    case JobState::kApproved:
      return to == JobState::kSending || to == JobState::kReceived;
    case JobState::kSending:
      return to == JobState::kApproved || to == JobState::kDone || to == JobState::kHandedOver;
    default:
      return false;
  }
}

bool may_begin(JobState state) {
  return state == JobState::kClaiming || state == JobState::kReceived || state == JobState::kReady;
}

}  // namespace packmerger
