// Cells and positions on the packer's grids: what the height field and the columns of matter share.
#pragma once

#include <limits>

#include "base/geometry.h"
#include "pack/maps/heights.h"

namespace packmerger {

// Positions, or cells, along one axis.
struct Range {
  int first = 0;
  int last = -1;
  bool empty() const { return last < first; }
  int count() const { return last - first + 1; }
};

inline constexpr Range kAllCells{std::numeric_limits<int>::min(), std::numeric_limits<int>::max()};

Range intersection(const Range& a, const Range& b);

// Cells that cover a length, at least one; rounding adds none.
int cells_along(double length_mm, double cell_mm);

// Cells by which a part grown by the gap may stand out of its matter.
int growth_cells(double gap_mm, double cell_mm);

// Horizontal distance along one axis of two cells that lie `cells` apart: the least one of any two
// of their points, or that of their centres.
double apart_mm(int cells, double cell_mm, bool any_points);

// The highest z of matter in a build volume of this height, units.
Height ceiling_units(double build_z_mm, double unit_mm);

// Length of a unit, mm, for a build volume of this height: 1/64, or more where the sum of two
// heights would not fit 16 bits.
double height_unit_mm(double build_z_mm);

// Of a part with the given box in its own frame: positions along an axis (0 or 1) at which it lies
// within the tray.
Range inside_tray(const Box3& part, const Vec3& build_mm, double cell_mm, int axis);

// Positions up to the first one beside all contents. From there on a part stands on the bare plate,
// costs no less and loses every tie. On an empty tray that is the first of all.
Range up_to_bare_plate(const Box3& contents, double cell_mm, int growth, int axis);

// The position in a range at which the contents grow least along an axis: there or one before.
int least_growth(const Range& range, const Box3& contents, const Box3& part, double cell_mm,
                 int axis);

// Size of the contents with a part moved by `at`, as TrayMeasure::size_mm: z from the plate up.
inline Vec3 size_with(const Box3& contents, const Box3& part, const Vec3& at) {
  // The corners of an empty box decide nothing.
  const Vec3 low = contents.min().cwiseMin(part.min() + at);
  const Vec3 high = contents.max().cwiseMax(part.max() + at);
  return {high.x() - low.x(), high.y() - low.y(), high.z()};
}

}  // namespace packmerger
