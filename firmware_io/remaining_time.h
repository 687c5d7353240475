// How long a print will still take, learned from what was printed so far.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace packmerger {

class GcodeCommands;
namespace s3g {
class Actions;
}

// The program's own idea of its time: after `done` lines or bytes, expected_s seconds have passed.
struct TimeMark {
  std::size_t done = 0;
  double expected_s = 0;
};

// Whether the program carries its slicer's clock: at least two marks (M73 R, minutes left).
bool has_slicer_marks(const GcodeCommands& commands);

// From the slicer's marks (M73 R, minutes left) where the program has them, otherwise from the
// lengths and speeds of its moves and its dwells; heating and homing count nothing. done: commands.
std::vector<TimeMark> time_marks(const GcodeCommands& commands);

// From the moves and delays of an x3g program. done: its bytes.
std::vector<TimeMark> time_marks(const s3g::Actions& actions);

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
