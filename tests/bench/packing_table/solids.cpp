#include "bench/packing_table/solids.h"

#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <utility>

namespace packmerger::bench {
namespace {

using Index = std::array<int, 3>;

// The points of a grid that are in use, numbered as they come.
class GridPoints {
 public:
  GridPoints(const std::array<const std::vector<double>*, 3>& lines,
             const std::function<Vec3(const Vec3&)>& warp, TriangleSoup& soup)
      : lines_(lines), warp_(warp), soup_(soup) {}

  int operator()(const Index& at) {
    const auto [found, is_new] = numbers_.emplace(at, static_cast<int>(soup_.points.size()));
    if (is_new) {
      Vec3 point;
      for (std::size_t axis = 0; axis < 3; ++axis)
        point[static_cast<Eigen::Index>(axis)] =
            (*lines_[axis])[static_cast<std::size_t>(at[axis])];
      soup_.points.push_back(warp_ ? warp_(point) : point);
    }
    return found->second;
  }

 private:
  std::array<const std::vector<double>*, 3> lines_;
  const std::function<Vec3(const Vec3&)>& warp_;
  TriangleSoup& soup_;
  std::map<Index, int> numbers_;
};

}  // namespace

Mesh block_solid(const std::vector<double>& xs, const std::vector<double>& ys,
                 const std::vector<double>& zs, const std::function<bool(int, int, int)>& filled,
                 const std::function<Vec3(const Vec3&)>& warp) {
  TriangleSoup soup;
  GridPoints point({&xs, &ys, &zs}, warp, soup);
  const Index cells{static_cast<int>(xs.size()) - 1, static_cast<int>(ys.size()) - 1,
                    static_cast<int>(zs.size()) - 1};
  const auto is_matter = [&](const Index& at) {
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (at[axis] < 0 || at[axis] >= cells[axis]) return false;
    return filled(at[0], at[1], at[2]);
  };
  for (int k = 0; k < cells[2]; ++k)
    for (int j = 0; j < cells[1]; ++j)
      for (int i = 0; i < cells[0]; ++i) {
        const Index cell{i, j, k};
        if (!is_matter(cell)) continue;
        for (std::size_t axis = 0; axis < 3; ++axis)
          for (const int side : {0, 1}) {
            Index beside = cell;
            beside[axis] += side == 1 ? 1 : -1;
            if (is_matter(beside)) continue;
            // the side's corners, counter-clockwise seen from the axis' positive end
            std::array<int, 4> corners{};
            for (std::size_t c = 0; c < 4; ++c) {
              Index at = cell;
              at[axis] += side;
              at[(axis + 1) % 3] += c == 1 || c == 2 ? 1 : 0;
              at[(axis + 2) % 3] += c >= 2 ? 1 : 0;
              corners[c] = point(at);
            }
            if (side == 0) std::swap(corners[1], corners[3]);
            soup.triangles.push_back({corners[0], corners[1], corners[2]});
            soup.triangles.push_back({corners[0], corners[2], corners[3]});
          }
      }
  return closed_mesh(std::move(soup));
}

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
