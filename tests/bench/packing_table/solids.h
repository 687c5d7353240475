// Prisms over flat figures.
#pragma once

#include <array>
#include <vector>

#include "model/mesh.h"

namespace packmerger::bench {

// Triangles in the plane, counter-clockwise, that share their corners with their neighbours.
struct FlatFigure {
  std::vector<Vec2> points;
  std::vector<std::array<int, 3>> triangles;
};

// What lies between two curves of as many points, the second to the left of the first: a ring where
// they are closed, a strip where they are not.
FlatFigure between(const std::vector<Vec2>& right, const std::vector<Vec2>& left, bool closed);

// From z = 0 to `height`.
Mesh prism(const FlatFigure& figure, double height);

// Every length times `factor`.
Mesh scaled(const Mesh& mesh, double factor);

// `count` points on a circle round the origin, counter-clockwise from the x axis on.
std::vector<Vec2> circle(double radius, int count);

}  // namespace packmerger::bench
