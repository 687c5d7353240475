// Closed solids from few numbers: cells of a rectilinear grid, and prisms over flat figures.
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "model/mesh.h"

namespace packmerger::bench {

// The surface of the cells (i, j, k) of the grid of lines xs, ys, zs (ascending, mm) for which
// filled() holds, its points moved by `warp`, which must turn nothing inside out. Throws
// Error{kBadInput} where two cells meet at an edge or a corner alone.
Mesh block_solid(const std::vector<double>& xs, const std::vector<double>& ys,
                 const std::vector<double>& zs, const std::function<bool(int, int, int)>& filled,
                 const std::function<Vec3(const Vec3&)>& warp = {});

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
