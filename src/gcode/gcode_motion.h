// Follows a G-code program line by line: where the head is, how it gets there, what it pushes out
// and how long that takes. The one reading of moves that checks, sums and clocks share.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "gcode/arc.h"
#include "gcode/gcode_line.h"

namespace packmerger {

// Along X, Y and Z, in the machine's own coordinates, mm; empty where nobody knows.
using MachinePoint = std::array<std::optional<double>, 3>;

struct GcodeStep {
  bool moves = false;  // G0 to G3
  MachinePoint from;
  MachinePoint to;
  std::array<bool, 3> named{};  // the axes that the line names
  std::optional<Arc> arc;       // where both ends are known
  double way_mm = 0;            // of the head; along axes that are known, arcs by their length
  double filament_mm = 0;       // pushed out; negative where it is drawn back
  std::array<double, 2> by_tool_mm{};  // the same for each tool, before M221
  double time_s = 0;  // of moves at their feed rate and of dwells; acceleration is left out
  // Why it cannot be followed, ready to stand behind "Line 3 of the program, …, ".
  std::optional<std::string> doubt;
};

// Understands G0 G1 G2 G3 (I J, R and P), G4, G20 G21, G28, G29 and G80, G90 G91, G92, M18 M84,
// M82 M83, M81, M200, M220, M221, and for gpx G161, G162, M132 and
// tools. Everything else is left to
// cannot_follow() (gcode/known_codes.h).
class GcodeMotion {
 public:
  explicit GcodeMotion(GcodeRules rules) : rules_(rules) {}

  GcodeStep follow(const GcodeLine& line);

  // Whether the machine knows where the axis is (0 to 2): it was homed, recalled or set.
  bool is_placed(int axis) const { return placed_[axis]; }
  double unit_mm() const { return unit_mm_; }
  // The tool that E stands for; 0 before one was chosen.
  int tool() const { return tool_.value_or(0); }

 private:
  void follow_g(const GcodeLine& line, GcodeStep& step);
  void follow_m(const GcodeLine& line, GcodeStep& step);
  void follow_t(const GcodeLine& line, GcodeStep& step);
  void move(const GcodeLine& line, GcodeStep& step);
  void bend(const GcodeLine& line, GcodeStep& step);
  void go(const GcodeLine& line, GcodeStep& step);
  void push(const GcodeLine& line, GcodeStep& step);
  std::size_t filament_of(char word) const;
  void home(const GcodeLine& line);
  void forget(const GcodeLine& line, bool placed);
  void set(const GcodeLine& line);

  GcodeRules rules_;
  MachinePoint at_;
  std::array<bool, 3> placed_{};
  std::array<double, 3> shift_mm_{};  // machine = program + shift
  std::array<double, 2> e_{};  // of A and B in the program's own unit; Marlin's E is the first
  std::optional<int> tool_;
  double unit_mm_ = 1;
  double mm_per_e_ = 1;  // less where the program counts filament in mm³
  double flow_ = 1;
  double speed_ = 1;
  double feed_mm_s_ = 0;
  bool relative_ = false;
  bool relative_e_ = false;
};

}  // namespace packmerger
