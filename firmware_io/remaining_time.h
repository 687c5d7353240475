// How long a print will still take, learned from what was printed so far.
#pragma once

#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

namespace packmerger {

// The program's own idea of its time: after `done` lines or bytes, expected_s seconds have passed.
struct TimeMark {
  std::size_t done = 0;
  double expected_s = 0;
};

// Gathers marks step by step; of a long program it keeps every n-th, and the last.
class TimeMarks {
 public:
  explicit TimeMarks(std::size_t steps);
  void add(std::size_t done, double expected_s, bool is_last);
  std::vector<TimeMark> take() { return std::move(marks_); }

 private:
  std::size_t every_;
  std::size_t steps_ = 0;
  std::vector<TimeMark> marks_;
};

class RemainingTime {
 public:
  explicit RemainingTime(std::vector<TimeMark> marks);  // ascending

  // printed_s: spent printing, pauses and heating not counted. The ratio to what was expected so
  // far is taken for the rest too; in the beginning the expectation counts for more. Nothing where
  // the program tells no time.
  std::optional<double> remaining_s(std::size_t done, double printed_s) const;

 private:
  double expected_s(std::size_t done) const;

  std::vector<TimeMark> marks_;
};

}  // namespace packmerger
