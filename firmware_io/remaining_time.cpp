#include "firmware_io/remaining_time.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "firmware_io/gcode/gcode.h"
#include "firmware_io/s3g/s3g.h"
#include "firmware_io/s3g/s3g_actions.h"
#include "gcode/gcode_motion.h"

namespace packmerger {

namespace {

constexpr std::size_t kMostMarks = 1000;

// Keeps every n-th mark, and the last.
class Marks {
 public:
  explicit Marks(std::size_t steps) : every_(std::max<std::size_t>(steps / kMostMarks, 1)) {
    marks_.push_back({});
  }
  void add(std::size_t done, double expected_s, bool is_last) {
    if (++steps_ % every_ == 0 || is_last) marks_.push_back({done, expected_s});
  }
  std::vector<TimeMark> take() { return std::move(marks_); }

 private:
  std::size_t every_;
  std::size_t steps_ = 0;
  std::vector<TimeMark> marks_;
};

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

double seconds_of(std::string_view action) {
  const auto integer = [&](std::size_t at, std::size_t size) {
    return static_cast<double>(s3g::read_integer(action.substr(at, size)));
  };
  switch (static_cast<std::uint8_t>(action[0])) {
    case s3g::kDelay:
      return integer(1, 4) / 1000;
    case s3g::kMoveIn:
      return integer(21, 4) / 1e6;
    case s3g::kMoveAlong: {
      float way_mm = 0;
      const std::uint32_t bits = s3g::read_integer(action.substr(26, 4));
      std::memcpy(&way_mm, &bits, sizeof way_mm);
      const double speed_mm_s = integer(30, 2) / 64;
      return speed_mm_s > 0 && std::isfinite(way_mm) ? std::abs(way_mm) / speed_mm_s : 0;
    }
    default:
      return 0;
  }
}

}  // namespace

bool has_slicer_marks(const GcodeCommands& commands) { return !slicer_marks(commands).empty(); }

std::vector<TimeMark> time_marks(const GcodeCommands& commands) {
  if (std::vector<TimeMark> marks = slicer_marks(commands); !marks.empty()) return marks;
  GcodeMotion motion(GcodeRules::kMarlin);
  const std::size_t count = commands.count();
  Marks marks(count);
  double expected_s = 0;
  std::size_t done = 0;
  for (const GcodeCommand& command : commands) {
    expected_s += motion.follow(GcodeLine(command.text, GcodeRules::kMarlin)).time_s;
    ++done;
    marks.add(done, expected_s, done == count);
  }
  return marks.take();
}

std::vector<TimeMark> time_marks(const s3g::Actions& actions) {
  Marks marks(actions.size());
  double expected_s = 0;
  for (std::size_t i = 0; i < actions.size(); ++i) {
    expected_s += seconds_of(actions[i]);
    marks.add(actions.done(i), expected_s, i + 1 == actions.size());
  }
  return marks.take();
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
