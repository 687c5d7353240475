// Closed meshes with known measures, for tests.
#pragma once

#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <vector>

#include "base/random.h"
#include "model/mesh.h"

namespace packmerger::shapes {

// An axis-aligned box of the given size, its least corner at `at`.
inline Mesh box(const Vec3& size, const Vec3& at = Vec3::Zero()) {
  TriangleSoup soup;
  for (int i = 0; i < 8; ++i)
    soup.points.push_back(at + size.cwiseProduct(Vec3(i & 1, (i >> 1) & 1, (i >> 2) & 1)));
  soup.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return closed_mesh(soup);
}

inline Mesh tetrahedron(double side) {
  TriangleSoup soup;
  soup.points = {Vec3(0, 0, 0), Vec3(side, 0, 0), Vec3(0, side, 0), Vec3(0, 0, side)};
  soup.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
  return closed_mesh(soup);
}

// The solid between a polygon in the x-z plane (counter-clockwise seen from -y) and its copy at
// y = depth. The polygon is cut into triangles by a fan round each of the given (convex) pieces.
inline Mesh extruded(const std::vector<Vec2>& polygon,
                     const std::vector<std::vector<int>>& convex_pieces, double depth) {
  TriangleSoup soup;
  const int n = static_cast<int>(polygon.size());
  for (const double y : {0.0, depth})
    for (const Vec2& p : polygon) soup.points.emplace_back(p.x(), y, p.y());
  for (const std::vector<int>& piece : convex_pieces)
    for (std::size_t i = 1; i + 1 < piece.size(); ++i) {
      soup.triangles.push_back({piece[0], piece[i], piece[i + 1]});
      soup.triangles.push_back({piece[0] + n, piece[i + 1] + n, piece[i] + n});
    }
  for (int i = 0; i < n; ++i) {
    const int j = (i + 1) % n;
    soup.triangles.push_back({i, i + n, j});
    soup.triangles.push_back({j, i + n, j + n});
  }
  return closed_mesh(soup);
}

// An L of two legs of length `leg`, `thick` mm thick, `depth` mm wide.
inline Mesh l_shape(double leg, double thick, double depth) {
  return extruded({{0, 0}, {leg, 0}, {leg, thick}, {thick, thick}, {thick, leg}, {0, leg}},
                  {{0, 1, 2, 3}, {0, 3, 4, 5}}, depth);
}

// A surface made of a grid of points, rows × columns, whose columns wrap round; the first and the
// last row are closed by one point each.
inline Mesh revolved(const std::vector<Vec2>& profile, int sides) {
  // profile: (radius, z) from the lowest axis point to the last axis point, radius 0 at both ends.
  TriangleSoup soup;
  const int rings = static_cast<int>(profile.size()) - 2;
  soup.points.emplace_back(0, 0, profile.front().y());
  for (int ring = 1; ring <= rings; ++ring)
    for (int side = 0; side < sides; ++side) {
      const double angle = 2 * std::numbers::pi * side / sides;
      const Vec2& p = profile[static_cast<std::size_t>(ring)];
      soup.points.emplace_back(p.x() * std::cos(angle), p.x() * std::sin(angle), p.y());
    }
  soup.points.emplace_back(0, 0, profile.back().y());
  const int last = static_cast<int>(soup.points.size()) - 1;
  const auto at = [&](int ring, int side) { return 1 + ring * sides + side % sides; };
  for (int side = 0; side < sides; ++side) {
    soup.triangles.push_back({0, at(0, side + 1), at(0, side)});
    soup.triangles.push_back({last, at(rings - 1, side), at(rings - 1, side + 1)});
    for (int ring = 0; ring + 1 < rings; ++ring) {
      soup.triangles.push_back({at(ring, side), at(ring, side + 1), at(ring + 1, side + 1)});
      soup.triangles.push_back({at(ring, side), at(ring + 1, side + 1), at(ring + 1, side)});
    }
  }
  return closed_mesh(soup);
}

inline Mesh sphere(double radius, int sides) {
  std::vector<Vec2> profile;
  for (int i = 0; i <= sides / 2; ++i) {
    const double angle = std::numbers::pi * i / (sides / 2);
    profile.emplace_back(i == 0 || i == sides / 2 ? 0 : radius * std::sin(angle),
                         -radius * std::cos(angle));
  }
  return revolved(profile, sides);
}

// Opens upwards; stands on z = 0.
inline Mesh cup(double radius, double height, double wall, int sides = 24) {
  return revolved({{0, 0},
                   {radius, 0},
                   {radius, height},
                   {radius - wall, height},
                   {radius - wall, wall},
                   {0, wall}},
                  sides);
}

// Half of a spherical shell, open upwards, lowest point at z = 0.
inline Mesh bowl(double radius, double wall, int sides = 24) {
  std::vector<Vec2> profile;
  const int steps = sides / 3;
  for (int i = 0; i <= steps; ++i) {
    const double angle = 0.45 * std::numbers::pi * i / steps;
    profile.emplace_back(radius * std::sin(angle), radius - radius * std::cos(angle));
  }
  for (int i = steps; i >= 0; --i) {
    const double angle = 0.45 * std::numbers::pi * i / steps;
    profile.emplace_back((radius - wall) * std::sin(angle),
                         radius - (radius - wall) * std::cos(angle));
  }
  return revolved(profile, sides);
}

// One of the six patches a shell of the given outer radius is cut into by the faces of a cube;
// `face` 0..5: +x, -x, +y, -y, +z, -z. n × n quads on each side.
inline Mesh sphere_patch(double radius, double wall, int face, int n) {
  TriangleSoup soup;
  const auto point = [&](int i, int j, double r) {
    const double u = std::tan(std::numbers::pi / 4 * (2.0 * i / n - 1));
    const double v = std::tan(std::numbers::pi / 4 * (2.0 * j / n - 1));
    const int axis = face / 2;
    const double sign = face % 2 == 0 ? 1 : -1;
    Vec3 p;
    p[axis] = sign;
    p[(axis + 1) % 3] = u;
    p[(axis + 2) % 3] = sign * v;
    return Vec3(r * p.normalized());
  };
  const int side = n + 1;
  for (const double r : {radius, radius - wall})
    for (int i = 0; i <= n; ++i)
      for (int j = 0; j <= n; ++j) soup.points.push_back(point(i, j, r));
  const int inner = side * side;
  const auto at = [&](int i, int j) { return i * side + j; };
  const auto quad = [&](int a, int b, int c, int d) {
    soup.triangles.push_back({a, b, c});
    soup.triangles.push_back({a, c, d});
  };
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      quad(at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
      quad(inner + at(i, j), inner + at(i, j + 1), inner + at(i + 1, j + 1), inner + at(i + 1, j));
    }
  for (int i = 0; i < n; ++i) {
    quad(at(i, 0), inner + at(i, 0), inner + at(i + 1, 0), at(i + 1, 0));
    quad(at(i + 1, n), inner + at(i + 1, n), inner + at(i, n), at(i, n));
    quad(at(0, i + 1), inner + at(0, i + 1), inner + at(0, i), at(0, i));
    quad(at(n, i), inner + at(n, i), inner + at(n, i + 1), at(n, i + 1));
  }
  return closed_mesh(soup);
}

inline Mat3 any_rotation(Random& random) {
  return (Eigen::AngleAxisd(6 * random.unit(), Vec3::UnitZ()) *
          Eigen::AngleAxisd(6 * random.unit(), Vec3::UnitX()) *
          Eigen::AngleAxisd(6 * random.unit(), Vec3::UnitY()))
      .toRotationMatrix();
}

inline Mesh turned(const Mesh& mesh, const Mat3& rotation) {
  Pose pose = Pose::Identity();
  pose.linear() = rotation;
  return transformed(mesh, pose);
}

// A few of the above, with cavities and without.
inline std::vector<Mesh> solids() {
  return {cup(8, 12, 2, 12), l_shape(14, 4, 6), box(Vec3(5, 9, 12)), bowl(9, 2, 12)};
}

// One of them, any way round.
inline Mesh random_solid(Random& random) {
  const std::size_t kind = random.below(4);
  return turned(solids()[kind], any_rotation(random));
}

}  // namespace packmerger::shapes
