// The arcs of G2 and G3 as Marlin and gpx read them, seen from above, mm and radians.
#pragma once

#include <optional>

#include "base/geometry.h"

namespace packmerger {

struct Arc {
  Vec2 centre = Vec2::Zero();
  double start_radius_mm = 0;  // programs round: the two differ a little
  double end_radius_mm = 0;
  double start = 0;  // angle of the start, from +x counter-clockwise
  double sweep = 0;  // counter-clockwise positive; more than a turn where the program asks for it

  double length_mm(double rise_mm) const;
  // The point after this part of the way, from 0 to 1.
  Vec2 at(double part) const;
  // All that the arc touches.
  Eigen::AlignedBox2d extent() const;
  // Pieces that leave the arc by less than deviation_mm when it is drawn in straight lines.
  int pieces(double deviation_mm) const;
};

// Around from + offset. turns: whole circles drawn before. An end at the start is a whole circle.
// Nothing where the centre is the start.
std::optional<Arc> arc_around(const Vec2& from, const Vec2& to, const Vec2& offset, bool clockwise,
                              int turns);

// By radius: a positive one takes the shorter way round. Nothing where it is too small to reach, or
// both ends are one point.
std::optional<Arc> arc_by_radius(const Vec2& from, const Vec2& to, double radius_mm, bool clockwise,
                                 int turns);

}  // namespace packmerger
