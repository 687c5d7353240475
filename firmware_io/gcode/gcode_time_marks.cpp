#include "firmware_io/gcode/gcode_time_marks.h"

#include <optional>
#include <string_view>

#include "firmware_io/gcode/gcode.h"
#include "gcode/gcode_motion.h"

namespace packmerger {
namespace {

// What "M73 R25" tells; nothing for other commands.
std::optional<double> minutes_left(std::string_view command) {
  const GcodeLine line(command, GcodeRules::kMarlin);
  return line.is('M', 73) ? line.value('R') : std::nullopt;
}

std::vector<TimeMark> slicer_marks(const GcodeCommands& commands) {
  std::vector<TimeMark> marks;
  double total_s = 0;
  std::size_t done = 0;
  for (const GcodeCommand& command : commands) {
    const std::size_t before = done++;
    const std::optional<double> left_min = minutes_left(command.text);
    if (!left_min) continue;
    if (marks.empty()) total_s = 60 * *left_min;
    const double expected_s = total_s - 60 * *left_min;
    if (marks.empty() || expected_s > marks.back().expected_s)
      marks.push_back({before, expected_s});
  }
  if (marks.size() < 2) return {};
  marks.push_back({done, total_s});
  return marks;
}

}  // namespace

bool has_slicer_marks(const GcodeCommands& commands) { return !slicer_marks(commands).empty(); }

std::vector<TimeMark> time_marks(const GcodeCommands& commands) {
  if (std::vector<TimeMark> marks = slicer_marks(commands); !marks.empty()) return marks;
  GcodeMotion motion(GcodeRules::kMarlin);
  const std::size_t count = commands.count();
  TimeMarks marks(count);
  double expected_s = 0;
  std::size_t done = 0;
  for (const GcodeCommand& command : commands) {
    expected_s += motion.follow(GcodeLine(command.text, GcodeRules::kMarlin)).time_s;
    ++done;
    marks.add(done, expected_s, done == count);
  }
  return marks.take();
}

}  // namespace packmerger
