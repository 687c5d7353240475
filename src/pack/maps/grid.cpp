#include "pack/maps/grid.h"

#include <algorithm>
#include <cmath>

namespace packmerger {
namespace {

constexpr double kCellTolerance = 1e-7;  // of a cell
constexpr double kUnitTolerance = 1e-6;  // of a unit
constexpr double kTolerance_mm = 1e-9;
constexpr double kFinestUnit_mm = 1.0 / 64;
constexpr double kMostUnits = 16000;  // sums of two stay in 16 bits

}  // namespace

Range intersection(const Range& a, const Range& b) {
  return {std::max(a.first, b.first), std::min(a.last, b.last)};
}

int cells_along(double length_mm, double cell_mm) {
  return std::max(1, static_cast<int>(std::ceil(length_mm / cell_mm - kCellTolerance)));
}

int growth_cells(double gap_mm, double cell_mm) {
  return static_cast<int>(std::ceil(gap_mm / cell_mm));
}

double apart_mm(int cells, double cell_mm, bool any_points) {
  return (any_points ? std::max(0, std::abs(cells) - 1) : std::abs(cells)) * cell_mm;
}

Height ceiling_units(double build_z_mm, double unit_mm) {
  return static_cast<Height>(std::floor(build_z_mm / unit_mm + kUnitTolerance));
}

double height_unit_mm(double build_z_mm) {
  return std::max(kFinestUnit_mm, build_z_mm / kMostUnits);
}

Range inside_tray(const Box3& part, const Vec3& build_mm, double cell_mm, int axis) {
  const double before = -part.min()[axis] - kTolerance_mm;
  const double room = build_mm[axis] - part.max()[axis] + kTolerance_mm;
  return {static_cast<int>(std::ceil(before / cell_mm)),
          static_cast<int>(std::floor(room / cell_mm))};
}

Range up_to_bare_plate(const Box3& contents, double cell_mm, int growth, int axis) {
  if (contents.isEmpty()) return {0, 0};
  return {0, static_cast<int>(std::ceil(contents.max()[axis] / cell_mm)) + growth};
}

int least_growth(const Range& range, const Box3& contents, const Box3& part, double cell_mm,
                 int axis) {
  if (contents.isEmpty()) return range.first;
  const double at = (contents.min()[axis] - part.min()[axis]) / cell_mm;
  return std::clamp(static_cast<int>(std::ceil(std::clamp(at, -1e6, 1e6))), range.first,
                    range.last);
}

}  // namespace packmerger
