#include "firmware_io/remaining_time.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>

#include "firmware_io/gcode.h"
#include "firmware_io/s3g.h"

namespace packmerger {

namespace {

constexpr std::size_t kMostMarks = 1000;

// The value of a command's parameter, as that of 'R' in "M73 P10 R25".
std::optional<double> parameter(std::string_view command, char letter) {
  for (std::size_t i = 1; i + 1 < command.size(); ++i)
    if (command[i] == letter && command[i - 1] == ' ')
      return std::strtod(std::string(command.substr(i + 1)).c_str(), nullptr);
  return std::nullopt;
}

// The time of one command after the other, acceleration left out.
class Moves {
 public:
  double seconds(std::string_view command) {
    const std::string_view word = gcode_word(command);
    if (word == "G90") relative_ = relative_e_ = false;
    if (word == "G91") relative_ = relative_e_ = true;
    if (word == "M82") relative_e_ = false;
    if (word == "M83") relative_e_ = true;
    if (word == "G4")
      return parameter(command, 'S').value_or(parameter(command, 'P').value_or(0) / 1000);
    const bool moves = word == "G0" || word == "G1";
    if (!moves && word != "G92") return 0;
    if (const auto feed = parameter(command, 'F'); feed && *feed > 0) feed_mm_s_ = *feed / 60;
    const double way_mm = go(command, moves);
    return moves && feed_mm_s_ > 0 ? way_mm / feed_mm_s_ : 0;
  }

 private:
  double go(std::string_view command, bool moves) {
    constexpr std::array<char, 4> kAxes = {'X', 'Y', 'Z', 'E'};
    double squared_mm = 0;
    double extruded_mm = 0;
    for (std::size_t i = 0; i < kAxes.size(); ++i) {
      const auto to = parameter(command, kAxes[i]);
      if (!to) continue;
      const bool relative = moves && (i < 3 ? relative_ : relative_e_);
      const double way_mm = relative ? *to : *to - at_mm_[i];
      at_mm_[i] += way_mm;
      if (i < 3)
        squared_mm += way_mm * way_mm;
      else
        extruded_mm = std::abs(way_mm);
    }
    return squared_mm > 0 ? std::sqrt(squared_mm) : extruded_mm;
  }

  std::array<double, 4> at_mm_{};
  bool relative_ = false;
  bool relative_e_ = false;
  double feed_mm_s_ = 0;
};

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

std::vector<TimeMark> slicer_marks(const std::vector<GcodeCommand>& commands) {
  std::vector<TimeMark> marks;
  double total_s = 0;
  for (std::size_t i = 0; i < commands.size(); ++i) {
    if (gcode_word(commands[i].text) != "M73") continue;
    const auto left_min = parameter(commands[i].text, 'R');
    if (!left_min) continue;
    if (marks.empty()) total_s = 60 * *left_min;
    const double expected_s = total_s - 60 * *left_min;
    if (marks.empty() || expected_s > marks.back().expected_s) marks.push_back({i, expected_s});
  }
  if (marks.size() < 2) return {};
  marks.push_back({commands.size(), total_s});
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

std::vector<TimeMark> time_marks(const std::vector<GcodeCommand>& commands) {
  if (std::vector<TimeMark> marks = slicer_marks(commands); !marks.empty()) return marks;
  Moves moves;
  Marks marks(commands.size());
  double expected_s = 0;
  for (std::size_t i = 0; i < commands.size(); ++i) {
    expected_s += moves.seconds(commands[i].text);
    marks.add(i + 1, expected_s, i + 1 == commands.size());
  }
  return marks.take();
}

std::vector<TimeMark> time_marks(const std::vector<std::string_view>& actions,
                                 const std::vector<std::size_t>& counted) {
  Marks marks(actions.size());
  double expected_s = 0;
  for (std::size_t i = 0; i < actions.size(); ++i) {
    expected_s += seconds_of(actions[i]);
    marks.add(counted[i], expected_s, i + 1 == actions.size());
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
