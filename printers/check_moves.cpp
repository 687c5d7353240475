#include "printers/check_moves.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "printers/gcode_line.h"

namespace packmerger {
namespace {

constexpr double kToleranceMm = 0.01;  // programs carry three digits
constexpr double kInchMm = 25.4;
constexpr std::array<char, 3> kAxes{'X', 'Y', 'Z'};

// Codes that neither move an axis nor change what a move means: dwell, firmware retraction, the
// XY plane for arcs, probing the bed where it lies, stepper currents.
constexpr std::array<int, 8> kStillCodes{4, 10, 11, 17, 29, 80, 94, 130};
// Codes of letter M that shift the coordinates.
constexpr std::array<int, 3> kShiftingCodes{206, 218, 428};

using Where = std::array<std::optional<double>, 3>;  // empty: unknown

class Follower {
 public:
  explicit Follower(const Box3& volume) : volume_(volume) {}

  // What is wrong with the line, or nothing.
  std::optional<std::string> follow(const GcodeLine& line) {
    if (line.letter() == 'M') return follow_m(line);
    if (line.letter() == 'G') return follow_g(line);
    if (line.letter() == 0 && !line.readable()) return "cannot be read";
    return std::nullopt;
  }

 private:
  std::optional<std::string> follow_m(const GcodeLine& line) {
    if (line.is('M', 82)) relative_e_ = false;
    if (line.is('M', 83)) relative_e_ = true;
    if (line.is('M', 132)) forget(line);
    if (std::find(kShiftingCodes.begin(), kShiftingCodes.end(), line.number()) !=
        kShiftingCodes.end())
      return "shifts the coordinates in a way that cannot be followed";
    return std::nullopt;
  }

  std::optional<std::string> follow_g(const GcodeLine& line) {
    if (!line.readable() || line.has('G') || line.has('M')) return "cannot be read";
    if (line.sub_number() != 0) return "cannot be judged: this code is not known";
    switch (line.number()) {
      case 0:
      case 1:
        return move(line);
      case 2:
      case 3:
        return arc(line);
      case 20:
        unit_mm_ = kInchMm;
        return std::nullopt;
      case 21:
        unit_mm_ = 1;
        return std::nullopt;
      case 28:
        home(line);
        return std::nullopt;
      case 90:
      case 91:
        relative_ = relative_e_ = line.number() == 91;
        return std::nullopt;
      case 92:
        set(line);
        return std::nullopt;
      case 161:
      case 162:
        forget(line);
        return std::nullopt;
      default:
        if (std::find(kStillCodes.begin(), kStillCodes.end(), line.number()) != kStillCodes.end())
          return std::nullopt;
        return "cannot be judged: this code is not known";
    }
  }

  // The axes a homing command names; none named means all.
  static std::array<bool, 3> axes_of(const GcodeLine& line) {
    std::array<bool, 3> named{line.has('X'), line.has('Y'), line.has('Z')};
    if (!named[0] && !named[1] && !named[2]) named = {true, true, true};
    return named;
  }

  void home(const GcodeLine& line) {
    const std::array<bool, 3> named = axes_of(line);
    for (int axis = 0; axis < 3; ++axis)
      if (named[axis]) at_[axis] = shift_[axis] = 0;
  }

  void forget(const GcodeLine& line) {
    const std::array<bool, 3> named = axes_of(line);
    for (int axis = 0; axis < 3; ++axis) {
      if (!named[axis]) continue;
      at_[axis].reset();
      shift_[axis] = 0;
    }
  }

  void set(const GcodeLine& line) {
    for (int axis = 0; axis < 3; ++axis) {
      const std::optional<double> value = line.value(kAxes[axis]);
      if (!value) continue;
      const double named = *value * unit_mm_;
      if (at_[axis]) {
        shift_[axis] = *at_[axis] - named;
      } else {
        at_[axis] = named;
        shift_[axis] = 0;
      }
    }
    if (const std::optional<double> e = line.value('E')) e_ = *e;
  }

  // Where the words of a move lead, and whether they extrude.
  std::optional<Where> target(const GcodeLine& line) const {
    Where to = at_;
    for (int axis = 0; axis < 3; ++axis) {
      if (!line.has(kAxes[axis])) continue;
      const std::optional<double> value = line.value(kAxes[axis]);
      if (!value) return std::nullopt;
      const double mm = *value * unit_mm_;
      if (!relative_)
        to[axis] = mm + shift_[axis];
      else if (to[axis])
        *to[axis] += mm;
    }
    return to;
  }

  bool extrudes(const GcodeLine& line) {
    const std::optional<double> e = line.value('E');
    if (!e) return (line.value('A').value_or(0) != 0 || line.value('B').value_or(0) != 0);
    const double before = relative_e_ ? 0 : e_;
    if (!relative_e_) e_ = *e;
    return *e > before;
  }

  static bool moves(const GcodeLine& line) {
    return line.has('X') || line.has('Y') || line.has('Z');
  }

  std::optional<std::string> move(const GcodeLine& line) {
    const std::optional<Where> to = target(line);
    if (!to) return "cannot be read: an axis has no number";
    const bool extruding = extrudes(line) && moves(line);
    if (extruding) {
      for (int axis = 0; axis < 3; ++axis)
        if (!at_[axis] || !(*to)[axis])
          return fmt::format("extrudes where nobody knows {}: it was neither homed nor set",
                             kAxes[axis]);
    }
    at_ = *to;
    for (int axis = 0; axis < 3; ++axis)
      if (line.has(kAxes[axis]) && at_[axis])
        if (const auto fault = judge(axis, *at_[axis])) return fault;
    return std::nullopt;
  }

  std::optional<std::string> judge(int axis, double mm) const {
    const double low = volume_.min()[axis];
    const double high = volume_.max()[axis];
    const double beyond = std::max(low - mm, mm - high);
    if (beyond <= kToleranceMm) return std::nullopt;
    return fmt::format("goes to {} {:.2f}, {:.2f} mm beyond the build volume ({:.2f} to {:.2f})",
                       kAxes[axis], mm, beyond, low, high);
  }

  // The centre of an arc in the plane, or nothing where the words give none.
  std::optional<Vec2> centre(const GcodeLine& line, const Vec2& from, const Vec2& to) const {
    const std::optional<double> radius = line.value('R');
    if (!radius) {
      if (!line.value('I') && !line.value('J')) return std::nullopt;
      return from + unit_mm_ * Vec2(line.value('I').value_or(0), line.value('J').value_or(0));
    }
    const double r = *radius * unit_mm_;
    const Vec2 chord = to - from;
    const double half = chord.norm() / 2;
    if (half == 0 || std::abs(r) < half * (1 - 1e-6)) return std::nullopt;
    const double rise = std::sqrt(std::max(0.0, r * r - half * half));
    // a positive radius takes the shorter way round
    const double turn = (line.number() == 3) == (r > 0) ? 1 : -1;
    return from + chord / 2 + turn * rise * Vec2(-chord.y(), chord.x()).normalized();
  }

  std::optional<std::string> arc(const GcodeLine& line) {
    const Where start = at_;
    if (const auto fault = move(line)) return fault;
    if (!start[0] || !start[1] || !at_[0] || !at_[1])
      return "draws an arc where nobody knows X and Y: they were neither homed nor set";
    const Vec2 from(*start[0], *start[1]);
    const Vec2 to(*at_[0], *at_[1]);
    const std::optional<Vec2> middle = centre(line, from, to);
    if (!middle) return "draws an arc without a centre";
    const Vec2 a = from - *middle;
    const Vec2 b = to - *middle;
    const double radius = std::max(a.norm(), b.norm());
    const double direction = line.number() == 3 ? 1 : -1;  // G3 turns counter-clockwise
    constexpr double kTurn = 2 * std::numbers::pi;
    const auto turned = [&](double angle) {  // from the start, in [0, 2π)
      const double way = direction * (angle - std::atan2(a.y(), a.x()));
      return way - kTurn * std::floor(way / kTurn);
    };
    double sweep = turned(std::atan2(b.y(), b.x()));
    if ((to - from).norm() < 1e-6 || line.has('P')) sweep = kTurn;
    for (int quarter = 0; quarter < 4; ++quarter) {
      const double angle = quarter * std::numbers::pi / 2;
      if (turned(angle) > sweep) continue;
      const int axis = quarter % 2;
      const double mm = (*middle)[axis] + (quarter < 2 ? radius : -radius);
      if (const auto fault = judge(axis, mm)) return fault;
    }
    return std::nullopt;
  }

  Box3 volume_;
  Where at_;                       // in the machine's coordinates
  std::array<double, 3> shift_{};  // machine = program + shift
  double e_ = 0;
  double unit_mm_ = 1;
  bool relative_ = false;
  bool relative_e_ = false;
};

}  // namespace

Box3 machine_volume(const Profile& profile) {
  const Vec3 build = profile.build();
  if (profile.origin == Origin::kFrontLeft) return {Vec3(0, 0, 0), build};
  const Vec3 corner(-build.x() / 2, -build.y() / 2, 0);
  return {corner, corner + build};
}

std::optional<MoveFault> check_moves(std::string_view gcode, const Box3& volume) {
  Follower follower(volume);
  std::optional<MoveFault> fault;
  for_each_line(gcode, [&](std::string_view text, int number) {
    if (const auto what = follower.follow(GcodeLine(text)))
      fault = MoveFault{number, std::string(text), *what};
    return !fault;
  });
  return fault;
}

}  // namespace packmerger
