#include "bench/packing_table/solids.h"

#include <cmath>
#include <numbers>
#include <set>
#include <utility>

namespace packmerger::bench {

FlatFigure between(const std::vector<Vec2>& right, const std::vector<Vec2>& left, bool closed) {
  FlatFigure figure;
  const int n = static_cast<int>(right.size());
  figure.points = right;
  figure.points.insert(figure.points.end(), left.begin(), left.end());
  for (int i = 0; i < (closed ? n : n - 1); ++i) {
    const int next = (i + 1) % n;
    figure.triangles.push_back({i, next, n + next});
    figure.triangles.push_back({i, n + next, n + i});
  }
  return figure;
}

Mesh prism(const FlatFigure& figure, double height) {
  TriangleSoup soup;
  const int n = static_cast<int>(figure.points.size());
  for (const double z : {0.0, height})
    for (const Vec2& point : figure.points) soup.points.emplace_back(point.x(), point.y(), z);
  std::set<std::pair<int, int>> edges;
  for (const auto& [a, b, c] : figure.triangles) {
    soup.triangles.push_back({a, c, b});
    soup.triangles.push_back({n + a, n + b, n + c});
    for (const auto& edge : {std::pair(a, b), std::pair(b, c), std::pair(c, a)}) edges.insert(edge);
  }
  for (const auto& [from, to] : edges) {
    if (edges.count({to, from}) > 0) continue;
    soup.triangles.push_back({from, to, n + to});
    soup.triangles.push_back({from, n + to, n + from});
  }
  return closed_mesh(std::move(soup));
}

Mesh scaled(const Mesh& mesh, double factor) {
  std::vector<Vec3> points = mesh.points();
  for (Vec3& point : points) point *= factor;
  return mesh.with_points(std::move(points));
}

std::vector<Vec2> circle(double radius, int count) {
  std::vector<Vec2> points;
  for (int i = 0; i < count; ++i) {
    const double angle = 2 * std::numbers::pi * i / count;
    points.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
  }
  return points;
}

}  // namespace packmerger::bench
