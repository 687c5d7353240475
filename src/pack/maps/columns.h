// The support volume V_s of closed surfaces (paper, section 6), counted along vertical lines on
// the exact triangles. It shares nothing with the depth maps, so that one can check the other.
#pragma once

#include <functional>
#include <vector>

#include "model/mesh.h"

namespace packmerger {

// V_s is the sum, mm³.
struct ColumnSupport {
  double below = 0;   // under the lowest matter of every line, down to the plate
  double inside = 0;  // between matter and matter
};

// Counts on the lines through the cell centres of a grid with the given step: the empty lengths
// below a facet that needs support, down to the first matter below or to the plate at plate_mm.
// A facet needs support when its normal points down by more than support_angle (radians) below the
// horizontal. The surfaces must be closed, normals outward, and must not overlap.
ColumnSupport column_support(const std::vector<Mesh>& surfaces, double step_mm,
                             double support_angle, double plate_mm);

// Where a vertical line through a cell's centre passes through a facet.
struct Crossing {
  int row = 0;
  int column = 0;
  double z = 0;                // mm
  bool enters = false;         // going up, into matter
  bool needs_support = false;  // of the facet
  int surface = 0;             // index of the one that the facet belongs to
  Vec2 slope = Vec2::Zero();   // of the facet: dz/dx, dz/dy
};

// All of them for closed surfaces, by row, column and height; of two at one height the way out of
// matter comes first. As above, but surfaces that touch along facets may be given.
std::vector<Crossing> sorted_crossings(const std::vector<Mesh>& surfaces, double step_mm,
                                       double support_angle);

// Told of every empty length below a facet that needs support: what lies below, nullptr for the
// plate, and the facet.
using OnVoid = std::function<void(const Crossing* floor, const Crossing& roof, double height_mm)>;
void for_each_void(const std::vector<Crossing>& sorted, double plate_mm, const OnVoid& on_void);

// The z component of a facet's unit normal below which it needs support.
double support_normal_limit(double support_angle);

}  // namespace packmerger
