#include "shape/surface/t_junctions.h"

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

namespace packmerger {
namespace {

using Edge = std::pair<int, int>;

constexpr int kMaxRounds = 16;  // a triangle takes one for each of its edges
constexpr std::size_t kCheckEvery = 1 << 10;

// The open edges (those without exactly two triangles) and the points in which they end.
class Border {
 public:
  explicit Border(const TriangleSoup& soup) : soup_(soup) {
    for (const auto& t : soup.triangles)
      for (int k = 0; k < 3; ++k) ++sides_[std::minmax(t[k], t[(k + 1) % 3])];
    std::vector<int> points;
    for (const auto& [edge, count] : sides_) {
      if (count == 2) continue;
      points.push_back(edge.first);
      points.push_back(edge.second);
    }
    std::sort(points.begin(), points.end());
    points.erase(std::unique(points.begin(), points.end()), points.end());
    for (const int point : points) ordered_.emplace_back(along(soup.points[point]), point);
    std::sort(ordered_.begin(), ordered_.end());
  }

  bool is_open(int a, int b) const { return sides_.at(std::minmax(a, b)) != 2; }

  // From a to b, without either, and without the corner opposite.
  std::vector<int> points_between(int a, int b, int opposite, double tolerance_mm) const {
    const Vec3& from = soup_.points[a];
    const double length = (soup_.points[b] - from).norm();
    if (!(length > 0)) return {};
    const Vec3 direction = (soup_.points[b] - from) / length;
    std::vector<std::pair<double, int>> found;
    const auto [low, high] = std::minmax({along(from), along(soup_.points[b])});
    for (auto at =
             std::lower_bound(ordered_.begin(), ordered_.end(), std::pair(low - tolerance_mm, -1));
         at != ordered_.end() && at->first <= high + tolerance_mm; ++at) {
      const int point = at->second;
      if (point == a || point == b || point == opposite) continue;
      const Vec3 offset = soup_.points[point] - from;
      const double where = offset.dot(direction);
      if (where > tolerance_mm && where < length - tolerance_mm &&
          (offset - where * direction).norm() <= tolerance_mm)
        found.emplace_back(where, point);
    }
    std::sort(found.begin(), found.end());
    std::vector<int> points;
    for (const auto& [where, point] : found) points.push_back(point);
    return points;
  }

 private:
  // Askew, since edges along an axis are common and would all lie at one place.
  static double along(const Vec3& point) { return point.dot(Vec3(0.7071, 0.5388, 0.4581)); }

  const TriangleSoup& soup_;
  std::map<Edge, int> sides_;
  std::vector<std::pair<double, int>> ordered_;  // by their place along the askew direction
};

int divide_once(TriangleSoup& soup, double tolerance_mm, const Progress& progress) {
  const Border border(soup);
  int divided = 0;
  std::vector<std::array<int, 3>> triangles;
  for (std::size_t i = 0; i < soup.triangles.size(); ++i) {
    if (i % kCheckEvery == 0) progress.check();
    const auto& t = soup.triangles[i];
    bool is_divided = false;
    for (int k = 0; k < 3 && !is_divided; ++k) {
      const int b = t[(k + 1) % 3];
      const int opposite = t[(k + 2) % 3];
      if (!border.is_open(t[k], b)) continue;
      std::vector<int> corners = border.points_between(t[k], b, opposite, tolerance_mm);
      if (corners.empty()) continue;
      is_divided = true;
      corners.push_back(b);
      int last = t[k];
      for (const int corner : corners) {
        triangles.push_back({last, corner, opposite});
        last = corner;
      }
    }
    if (is_divided)
      ++divided;
    else
      triangles.push_back(t);
  }
  soup.triangles = std::move(triangles);
  return divided;
}

}  // namespace

int divide_at_t_junctions(TriangleSoup& soup, double tolerance_mm, const Progress& progress) {
  int divided = 0;
  for (int round = 0; round < kMaxRounds; ++round) {
    const int more = divide_once(soup, tolerance_mm, progress);
    divided += more;
    if (more == 0) break;
  }
  return divided;
}

}  // namespace packmerger
