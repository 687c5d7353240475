// Balls joined by round sticks, as one clean surface.
#pragma once

#include <vector>

#include "model/mesh.h"

namespace packmerger::bench {

struct Ball {
  Vec3 centre;
  double radius_mm = 0;
};

struct Stick {  // between two balls, by index; its axis goes through both centres
  int from = 0;
  int to = 0;
};

// Closed and 2-manifold, of evenly sized triangles: vertices lie on the balls and on the sticks,
// those where a stick meets a ball on both. Sticks are thinner than balls and keep clear of each
// other at their balls' surfaces; spacing_mm is about an edge's length.
TriangleSoup balls_and_sticks(const std::vector<Ball>& balls, const std::vector<Stick>& sticks,
                              double stick_radius_mm, double spacing_mm);

}  // namespace packmerger::bench
