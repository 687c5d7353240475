#include "gcode/gcode_motion.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "gcode/known_codes.h"

namespace packmerger {
namespace {

constexpr double kInchMm = 25.4;
constexpr std::array<char, 3> kAxes{'X', 'Y', 'Z'};
constexpr std::array<char, 3> kFilament{'E', 'A', 'B'};
constexpr double kMostTurns = 100;

constexpr const char* kUnreadable = "cannot be read";

std::array<bool, 3> axes_of(const GcodeLine& line) {
  return {line.has('X'), line.has('Y'), line.has('Z')};
}

// None named means all.
std::array<bool, 3> axes_or_all(const GcodeLine& line) {
  const std::array<bool, 3> named = axes_of(line);
  if (!named[0] && !named[1] && !named[2]) return {true, true, true};
  return named;
}

}  // namespace

GcodeStep GcodeMotion::follow(const GcodeLine& line) {
  GcodeStep step;
  step.from = at_;
  switch (line.letter()) {
    case 'G':
      follow_g(line, step);
      break;
    case 'M':
      follow_m(line, step);
      break;
    case 'T':
      follow_t(line, step);
      break;
    default:
      if (!line.readable()) step.doubt = kUnreadable;
  }
  step.to = at_;
  return step;
}

void GcodeMotion::follow_g(const GcodeLine& line, GcodeStep& step) {
  if (!line.readable() || line.has('G') || line.has('M')) step.doubt = kUnreadable;
  if (line.sub_number() != 0) {
    step.doubt = cannot_follow(line, rules_);
    return;
  }
  const bool gpx = rules_ == GcodeRules::kGpx;
  switch (line.number()) {
    case 0:
    case 1:
    case 2:
    case 3:
      return move(line, step);
    case 4:
      // gpx takes milliseconds alone; what is given to it is written so
      step.time_s =
          std::max(0.0, line.has('S') ? line.value_or('S', 0) : line.value_or('P', 0) / 1000);
      return;
    case 20:
      unit_mm_ = kInchMm;
      return;
    case 21:
      unit_mm_ = 1;
      return;
    case 28:
      return gpx ? forget(line, false) : home(line);
    case 29:
    case 80:
      // The bed is probed where it lies: afterwards the head is somewhere above it.
      if (gpx) break;
      return at_.fill(std::nullopt);
    case 90:
    case 91:
      relative_ = line.number() == 91;
      // Marlin's filament follows the axes until M82 or M83 comes again; gpx's does not
      if (!gpx) relative_e_ = relative_;
      return;
    case 92:
      return set(line);
    case 161:
    case 162:
      if (!gpx) break;
      return forget(line, false);
    default:
      break;
  }
  if (!step.doubt) step.doubt = cannot_follow(line, rules_);
}

void GcodeMotion::follow_m(const GcodeLine& line, GcodeStep& step) {
  const bool gpx = rules_ == GcodeRules::kGpx;
  switch (line.sub_number() == 0 ? line.number() : -1) {
    case 2:
      if (!gpx) break;
      return;
    case 18:
    case 84:
      // with a time or the extruder alone nothing is let go
      if (line.has('S') || (line.has('E') && !line.has('X') && !line.has('Y') && !line.has('Z')))
        return;
      for (int axis = 0; axis < 3; ++axis)
        if (axes_or_all(line)[axis]) placed_[axis] = false;
      return;
    case 81:
      if (gpx) break;
      return placed_.fill(false);
    case 82:
    case 83:
      relative_e_ = line.number() == 83;
      return;
    case 132:
      if (!gpx) break;
      // gpx takes its count of recalled filament for 0
      for (const char word : {'A', 'B'})
        if (line.has(word)) e_[filament_of(word)] = 0;
      return forget(line, true);
    case 200: {
      if (gpx) break;
      const double diameter_mm =
          line.has('S') && line.value_or('S', 1) == 0 ? 0 : line.value_or('D', 0) * unit_mm_;
      mm_per_e_ = diameter_mm > 0 ? 4 / (std::numbers::pi * diameter_mm * diameter_mm) : 1;
      return;
    }
    case 220:
      if (line.value_or('S', 0) > 0) speed_ = line.value_or('S', 0) / 100;
      return;
    case 221:
      if (line.value_or('S', 0) > 0) flow_ = line.value_or('S', 0) / 100;
      return;
    default:
      break;
  }
  step.doubt = cannot_follow(line, rules_);
  const bool changes_tool = line.number() == 6 || line.number() == 108 || line.number() == 135;
  if (!step.doubt && gpx && line.has('T') && changes_tool) follow_t(line, step);
}

// The first tool named is the one that is there; another stands elsewhere by an offset that only
// the machine knows.
void GcodeMotion::follow_t(const GcodeLine& line, GcodeStep& step) {
  const int tool = line.letter() == 'T' ? line.number() : static_cast<int>(line.value_or('T', 0));
  if (tool_.value_or(tool) != tool)
    step.doubt = "cannot be judged: where the other tool stands is not known";
  tool_ = tool;
}

void GcodeMotion::move(const GcodeLine& line, GcodeStep& step) {
  step.moves = true;
  step.named = axes_of(line);
  if (line.value_or('F', 0) > 0) feed_mm_s_ = line.value_or('F', 0) * unit_mm_ / 60;
  go(line, step);
  push(line, step);
  double squared_mm = 0;
  for (int axis = 0; axis < 3; ++axis)
    if (step.from[axis] && at_[axis])
      squared_mm += (*at_[axis] - *step.from[axis]) * (*at_[axis] - *step.from[axis]);
  step.way_mm = std::sqrt(squared_mm);
  if (line.number() >= 2) bend(line, step);
  const double way_mm = step.way_mm > 0 ? step.way_mm : std::abs(step.filament_mm);
  if (feed_mm_s_ > 0) step.time_s = way_mm / (feed_mm_s_ * speed_);
}

void GcodeMotion::go(const GcodeLine& line, GcodeStep& step) {
  for (int axis = 0; axis < 3; ++axis) {
    if (!step.named[axis]) continue;
    const std::optional<double> value = line.value(kAxes[axis]);
    if (!value) {
      step.doubt = "cannot be read: an axis has no number";
      continue;
    }
    const double mm = *value * unit_mm_;
    if (!relative_) {
      at_[axis] = mm + shift_mm_[axis];
    } else if (at_[axis]) {
      *at_[axis] += mm;
    } else if (axis < 2 || mm < 0) {
      // lifting the head from wherever it is does no harm, and start texts do it
      step.doubt = "moves on from a place that nobody knows";
    }
  }
}

// For gpx E stands for the filament of the tool that is chosen.
std::size_t GcodeMotion::filament_of(char word) const {
  const bool second = word == 'B' || (word == 'E' && rules_ == GcodeRules::kGpx && tool() == 1);
  return second ? 1 : 0;
}

void GcodeMotion::push(const GcodeLine& line, GcodeStep& step) {
  const bool gpx = rules_ == GcodeRules::kGpx;
  const bool relative = relative_e_ || (gpx && relative_);
  for (const char word : kFilament) {
    const std::optional<double> value = line.value(word);
    if (!value || (word != 'E' && !gpx)) continue;
    double& e = e_[filament_of(word)];
    const double pushed_mm = (*value - (relative ? 0 : e)) * unit_mm_ * mm_per_e_;
    step.by_tool_mm[filament_of(word)] += pushed_mm;
    step.filament_mm += pushed_mm * flow_;
    e = relative ? e + *value : *value;
  }
}

void GcodeMotion::bend(const GcodeLine& line, GcodeStep& step) {
  const MachinePoint& from = step.from;
  if (!from[0] || !from[1] || !at_[0] || !at_[1]) {
    step.doubt = "draws an arc where nobody knows X and Y: they were neither homed nor set";
    return;
  }
  const double turns = line.value_or('P', 0);
  if (turns < 0 || turns > kMostTurns || turns != std::floor(turns)) {
    step.doubt = "cannot be judged: an arc of so many turns";
    return;
  }
  const Vec2 start(*from[0], *from[1]);
  const Vec2 end(*at_[0], *at_[1]);
  const bool clockwise = line.number() == 2;
  if (const std::optional<double> radius = line.value('R'))
    step.arc = arc_by_radius(start, end, *radius * unit_mm_, clockwise, static_cast<int>(turns));
  else
    step.arc = arc_around(start, end, unit_mm_ * Vec2(line.value_or('I', 0), line.value_or('J', 0)),
                          clockwise, static_cast<int>(turns));
  if (!step.arc) {
    step.doubt = "draws an arc without a centre";
    return;
  }
  const double rise_mm = from[2] && at_[2] ? *at_[2] - *from[2] : 0;
  step.way_mm = step.arc->length_mm(rise_mm);
}

void GcodeMotion::home(const GcodeLine& line) {
  const std::array<bool, 3> named = axes_or_all(line);
  for (int axis = 0; axis < 3; ++axis) {
    if (!named[axis]) continue;
    at_[axis] = shift_mm_[axis] = 0;
    placed_[axis] = true;
  }
}

void GcodeMotion::forget(const GcodeLine& line, bool placed) {
  const std::array<bool, 3> named = axes_or_all(line);
  for (int axis = 0; axis < 3; ++axis) {
    if (!named[axis]) continue;
    at_[axis].reset();
    shift_mm_[axis] = 0;
    placed_[axis] = placed;
  }
}

void GcodeMotion::set(const GcodeLine& line) {
  for (int axis = 0; axis < 3; ++axis) {
    const std::optional<double> value = line.value(kAxes[axis]);
    if (!value) continue;
    const double named = *value * unit_mm_;
    if (at_[axis] && placed_[axis]) {
      shift_mm_[axis] = *at_[axis] - named;
    } else {
      at_[axis] = named;
      shift_mm_[axis] = 0;
      placed_[axis] = true;
    }
  }
  for (const char word : kFilament)
    if (const std::optional<double> value = line.value(word)) e_[filament_of(word)] = *value;
}

}  // namespace packmerger
