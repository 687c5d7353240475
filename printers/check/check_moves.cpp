#include "printers/check/check_moves.h"

#include <algorithm>

#include <fmt/format.h>

#include "gcode/gcode_motion.h"

namespace packmerger {
namespace {

constexpr double kToleranceMm = 0.01;  // programs carry three digits
constexpr const char* kAxes = "XYZ";

std::optional<std::string> judge(const Box3& volume, int axis, double mm) {
  const double low = volume.min()[axis];
  const double high = volume.max()[axis];
  const double beyond = std::max(low - mm, mm - high);
  if (beyond <= kToleranceMm) return std::nullopt;
  return fmt::format("goes to {} {:.2f}, {:.2f} mm beyond the build volume ({:.2f} to {:.2f})",
                     kAxes[axis], mm, beyond, low, high);
}

// Chords instead of arcs: they leave them by less than the tolerance.
std::vector<Vec2> way_of(const GcodeStep& step) {
  const Vec2 to(*step.to[0], *step.to[1]);
  std::vector<Vec2> way{Vec2(step.from[0].value_or(to.x()), step.from[1].value_or(to.y()))};
  const int pieces = step.arc ? step.arc->pieces(kToleranceMm) : 1;
  for (int i = 1; i < pieces; ++i) way.push_back(step.arc->at(static_cast<double>(i) / pieces));
  way.push_back(to);
  return way;
}

std::optional<std::string> judge(const Plate& plate, const GcodeStep& step) {
  if (!step.to[0] || !step.to[1]) return std::nullopt;
  const std::vector<Vec2> way = way_of(step);
  const auto fault = [](const Vec2& at, double beyond) {
    return fmt::format(
        "extrudes near X {:.2f} Y {:.2f}, {:.2f} mm beyond the edge of the plate or over a "
        "kept-out area",
        at.x(), at.y(), beyond);
  };
  for (std::size_t i = 0; i < way.size(); ++i) {
    const double beyond = -plate.nearest_wall(way[i]).clearance_mm;
    if (beyond > kToleranceMm) return fault(way[i], beyond);
    if (i == 0) continue;
    for (const Polygon& area : plate.barred())
      if (const double depth = depth_within(area, way[i - 1], way[i]); depth > kToleranceMm)
        return fault(way[i], depth);
  }
  return std::nullopt;
}

bool moves_and_extrudes(const GcodeStep& step) {
  return step.filament_mm > 0 && (step.named[0] || step.named[1] || step.named[2] || step.arc);
}

// What is wrong with the step, or nothing. motion: after it.
std::optional<std::string> fault_of(const GcodeStep& step, const GcodeMotion& motion,
                                    const Box3& volume, const Plate& plate) {
  if (step.doubt) return step.doubt;
  if (!step.moves) return std::nullopt;
  if (moves_and_extrudes(step))
    for (int axis = 0; axis < 3; ++axis)
      if (!motion.is_placed(axis))
        return fmt::format("extrudes where nobody knows {}: it was neither homed nor set",
                           kAxes[axis]);
  for (int axis = 0; axis < 3; ++axis)
    if (step.named[axis] && step.to[axis])
      if (auto fault = judge(volume, axis, *step.to[axis])) return fault;
  if (!plate.is_whole() && moves_and_extrudes(step))
    if (auto fault = judge(plate, step)) return fault;
  if (!step.arc) return std::nullopt;
  const Eigen::AlignedBox2d extent = step.arc->extent();
  for (int axis = 0; axis < 2; ++axis)
    for (const double mm : {extent.min()[axis], extent.max()[axis]})
      if (auto fault = judge(volume, axis, mm)) return fault;
  return std::nullopt;
}

}  // namespace

Box3 machine_volume(const Profile& profile) {
  const Vec3 build = profile.build();
  if (profile.origin == Origin::kFrontLeft) return {Vec3(0, 0, 0), build};
  const Vec3 corner(-build.x() / 2, -build.y() / 2, 0);
  return {corner, corner + build};
}

Plate machine_plate(const Profile& profile) {
  return profile.plate().drawn_in(-machine_volume(profile).min().head<2>(), 0);
}

std::optional<MoveFault> check_moves(std::string_view gcode, const Box3& volume, GcodeRules rules,
                                     const Plate& plate) {
  GcodeMotion motion(rules);
  std::optional<MoveFault> fault;
  for_each_line(gcode, [&](std::string_view text, int number) {
    const GcodeStep step = motion.follow(GcodeLine(text, rules));
    if (const auto what = fault_of(step, motion, volume, plate))
      fault = MoveFault{number, std::string(text), *what};
    return !fault;
  });
  return fault;
}

GcodeRules gcode_rules(const Profile& profile) {
  const ProgramLanguage* language = profile.language();
  return language != nullptr && language->from_gpx ? GcodeRules::kGpx : GcodeRules::kMarlin;
}

}  // namespace packmerger
