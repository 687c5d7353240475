#include "firmware_io/remaining_time.h"

#include <algorithm>

namespace packmerger {

namespace {

constexpr std::size_t kMostMarks = 1000;

}  // namespace

TimeMarks::TimeMarks(std::size_t steps) : every_(std::max<std::size_t>(steps / kMostMarks, 1)) {
  marks_.push_back({});
}

void TimeMarks::add(std::size_t done, double expected_s, bool is_last) {
  if (++steps_ % every_ == 0 || is_last) marks_.push_back({done, expected_s});
}

RemainingTime::RemainingTime(std::vector<TimeMark> marks) : marks_(std::move(marks)) {}

double RemainingTime::expected_s(std::size_t done) const {
  const auto after = std::upper_bound(
      marks_.begin(), marks_.end(), done,
      [](std::size_t position, const TimeMark& mark) { return position < mark.done; });
  if (after == marks_.begin()) return 0;
  if (after == marks_.end()) return marks_.back().expected_s;
  const TimeMark& before = *(after - 1);
  const double part =
      static_cast<double>(done - before.done) / static_cast<double>(after->done - before.done);
  return before.expected_s + part * (after->expected_s - before.expected_s);
}

std::optional<double> RemainingTime::remaining_s(std::size_t done, double printed_s) const {
  if (marks_.empty() || marks_.back().expected_s <= 0) return std::nullopt;
  const double total_s = marks_.back().expected_s;
  const double so_far_s = expected_s(done);
  // As much of the expectation is taken for experience.
  const double trusted_s = std::min(0.05 * total_s, 600.0);
  return (total_s - so_far_s) * (printed_s + trusted_s) / (so_far_s + trusted_s);
}

}  // namespace packmerger
