// Simple polygons in the plane of the plate, mm.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "base/geometry.h"

namespace packmerger {

// Corners in order, either way round, the first not repeated at the end.
using Polygon = std::vector<Vec2>;

inline constexpr std::size_t kMostCorners = 500;

// Why it is no simple polygon, as a clause ("its sides from corner 2 and corner 5 meet"), corners
// counted from 1; empty where it is one.
std::string fault_of(const Polygon& polygon);

// Above 0 where the corners run counter-clockwise.
double signed_area_mm2(const Polygon& polygon);
Polygon counter_clockwise(Polygon polygon);

// The corners of the convex hull, counter-clockwise, without those in the middle of a side.
Polygon convex_hull(std::vector<Vec2> points);

// Points on the border are either.
bool contains(const Polygon& polygon, const Vec2& at);

// The point of the border that is nearest.
Vec2 nearest_on_border(const Polygon& polygon, const Vec2& at);

// What of the stretch from a to b lies within the polygon, in order; on the border either.
using Stretch = std::array<Vec2, 2>;
std::vector<Stretch> pieces_within(const Polygon& polygon, const Vec2& a, const Vec2& b);

// How deep the stretch from a to b lies within the polygon where it does so deepest, sought in the
// middle of every piece of it that lies within; 0 where it stays outside or touches only.
double depth_within(const Polygon& polygon, const Vec2& a, const Vec2& b);

// A point well inside.
Vec2 inner_point(const Polygon& polygon);

Eigen::AlignedBox2d bounding_box(const Polygon& polygon);

}  // namespace packmerger
