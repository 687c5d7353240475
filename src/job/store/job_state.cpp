#include "job/store/job_state.h"

#include <algorithm>
#include <array>

#include "job/store/job_transitions.h"

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
  return std::any_of(kJobTransitions.begin(), kJobTransitions.end(), [&](const JobTransition& row) {
    return row.from.contains(from) && row.to == to;
  });
}

bool may_begin(JobState state) {
  return state == JobState::kClaiming || state == JobState::kReceived || state == JobState::kReady;
}

}  // namespace packmerger
