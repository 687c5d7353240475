// Meshes whose support volume, layers and material can be worked out by hand.
#pragma once

#include <array>
#include <functional>
#include <map>
#include <utility>
#include <vector>

#include "fixtures/models.h"
#include "model/mesh.h"
#include "model/tray.h"

namespace packmerger::printed {

inline Mesh box(const Vec3& low, const Vec3& high) { return closed_mesh(fixtures::box(low, high)); }

// About the origin.
inline Mesh scaled(const Mesh& mesh, double factor) {
  std::vector<Vec3> points = mesh.points();
  for (Vec3& point : points) point *= factor;
  return mesh.with_points(std::move(points));
}

inline Mesh moved(const Mesh& mesh, const Vec3& by) {
  Pose pose = Pose::Identity();
  pose.translate(by);
  return transformed(mesh, pose);
}

// A sphere resting on the plate.
inline Mesh resting_sphere(double radius_mm, int subdivisions = 6) {
  return moved(closed_mesh(fixtures::sphere(radius_mm, subdivisions)),
               Vec3(radius_mm + 10, radius_mm + 10, radius_mm));
}

// The surface of the filled cells of a grid with these lines. No two filled cells may touch along
// an edge or at a corner alone.
inline Mesh from_cells(const std::vector<double>& xs, const std::vector<double>& ys,
                       const std::vector<double>& zs,
                       const std::function<bool(int, int, int)>& filled) {
  const std::array<int, 3> cells{static_cast<int>(xs.size()) - 1, static_cast<int>(ys.size()) - 1,
                                 static_cast<int>(zs.size()) - 1};
  const auto full = [&](const std::array<int, 3>& at) {
    for (int axis = 0; axis < 3; ++axis)
      if (at[axis] < 0 || at[axis] >= cells[axis]) return false;
    return filled(at[0], at[1], at[2]);
  };
  TriangleSoup soup;
  std::map<std::array<int, 3>, int> index;
  const auto corner = [&](const std::array<int, 3>& at) {
    const auto [entry, fresh] = index.emplace(at, static_cast<int>(soup.points.size()));
    if (fresh) soup.points.emplace_back(xs[at[0]], ys[at[1]], zs[at[2]]);
    return entry->second;
  };
  for (int x = 0; x < cells[0]; ++x)
    for (int y = 0; y < cells[1]; ++y)
      for (int z = 0; z < cells[2]; ++z) {
        const std::array<int, 3> cell{x, y, z};
        if (!full(cell)) continue;
        for (int axis = 0; axis < 3; ++axis)
          for (const int side : {0, 1}) {
            std::array<int, 3> beside = cell;
            beside[axis] += side == 0 ? -1 : 1;
            if (full(beside)) continue;
            const int u = (axis + 1) % 3;
            const int v = (axis + 2) % 3;
            std::array<int, 3> a = cell;
            a[axis] += side;
            std::array<int, 3> b = a, c = a, d = a;
            ++b[u];
            ++c[u], ++c[v];
            ++d[v];
            if (side == 0) std::swap(b, d);
            soup.triangles.push_back({corner(a), corner(b), corner(c)});
            soup.triangles.push_back({corner(a), corner(c), corner(d)});
          }
      }
  return closed_mesh(soup);
}

// A square table: a slab on four square legs, one piece.
inline Mesh table(double side, double height, double top, double leg, const Vec3& at) {
  const auto lines = [&](double from) {
    return std::vector<double>{from, from + leg, from + side - leg, from + side};
  };
  return from_cells(lines(at.x()), lines(at.y()), {at.z(), at.z() + height - top, at.z() + height},
                    [](int x, int y, int z) { return z == 1 || (x != 1 && y != 1); });
}

// An open box upside down: walls and roof of the given thickness.
inline Mesh cover(const Vec3& size, double wall, const Vec3& at) {
  return from_cells({at.x(), at.x() + wall, at.x() + size.x() - wall, at.x() + size.x()},
                    {at.y(), at.y() + wall, at.y() + size.y() - wall, at.y() + size.y()},
                    {at.z(), at.z() + size.z() - wall, at.z() + size.z()},
                    [](int x, int y, int z) { return z == 1 || x != 1 || y != 1; });
}

// A square frustum with sides bottom and top, centred over (at.x, at.y).
inline Mesh frustum(double bottom, double top, double height, const Vec3& at) {
  TriangleSoup soup = fixtures::box(Vec3(-0.5, -0.5, 0), Vec3(0.5, 0.5, 1));
  for (Vec3& p : soup.points) {
    const double side = p.z() > 0.5 ? top : bottom;
    p = at + Vec3(p.x() * side, p.y() * side, p.z() * height);
  }
  return closed_mesh(soup);
}

inline Tray tray_of(std::vector<Mesh> parts) {
  Tray tray;
  tray.parts = std::move(parts);
  return tray;
}

// Every hole closed by a fan round the middle of its rim.
inline TriangleSoup with_holes_filled(TriangleSoup soup) {
  std::map<std::pair<int, int>, int> edges;
  for (const auto& [a, b, c] : soup.triangles)
    for (const auto& edge : {std::pair{a, b}, std::pair{b, c}, std::pair{c, a}}) ++edges[edge];
  std::map<int, int> rim;  // from a vertex to the next one round the hole
  for (const auto& [edge, count] : edges)
    if (edges.find({edge.second, edge.first}) == edges.end()) rim[edge.second] = edge.first;
  while (!rim.empty()) {
    std::vector<int> loop{rim.begin()->first};
    for (int next = rim.at(loop[0]); next != loop[0]; next = rim.at(next)) loop.push_back(next);
    Vec3 middle = Vec3::Zero();
    for (const int vertex : loop) middle += soup.points[vertex] / static_cast<double>(loop.size());
    const int centre = static_cast<int>(soup.points.size());
    soup.points.push_back(middle);
    for (std::size_t i = 0; i < loop.size(); ++i)
      soup.triangles.push_back({loop[i], loop[(i + 1) % loop.size()], centre});
    for (const int vertex : loop) rim.erase(vertex);
  }
  return soup;
}

}  // namespace packmerger::printed
