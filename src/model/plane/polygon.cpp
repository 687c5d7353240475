#include "model/plane/polygon.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace packmerger {
namespace {

constexpr double kSame_mm = 1e-9;
constexpr double kLeastArea_mm2 = 1e-6;

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

const Vec2& corner(const Polygon& polygon, std::size_t index) {
  return polygon[index % polygon.size()];
}

Vec2 nearest_on(const Vec2& a, const Vec2& b, const Vec2& at) {
  const Vec2 along = b - a;
  const double length2 = along.squaredNorm();
  if (!(length2 > 0)) return a;
  return a + std::clamp((at - a).dot(along) / length2, 0.0, 1.0) * along;
}

double distance(const Vec2& a, const Vec2& b, const Vec2& at) {
  return (nearest_on(a, b, at) - at).norm();
}

// Whether two sides have a point in common.
bool meet(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  const double c_side = cross(b - a, c - a);
  const double d_side = cross(b - a, d - a);
  const double a_side = cross(d - c, a - c);
  const double b_side = cross(d - c, b - c);
  if (((c_side > 0) != (d_side > 0)) && ((a_side > 0) != (b_side > 0)) && c_side != 0 &&
      d_side != 0 && a_side != 0 && b_side != 0)
    return true;
  return std::min({distance(a, b, c), distance(a, b, d), distance(c, d, a), distance(c, d, b)}) <=
         kSame_mm;
}

}  // namespace

double signed_area_mm2(const Polygon& polygon) {
  double twice = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i)
    twice += cross(polygon[i] - polygon[0], corner(polygon, i + 1) - polygon[0]);
  return twice / 2;
}

std::string fault_of(const Polygon& polygon) {
  const std::size_t count = polygon.size();
  if (count < 3) return fmt::format("it has {} corners, and at least 3 are needed", count);
  if (count > kMostCorners)
    return fmt::format("it has {} corners, and at most {} are taken", count, kMostCorners);
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t k = i + 1; k < count; ++k)
      if ((polygon[i] - polygon[k]).norm() <= kSame_mm)
        return fmt::format("its corners {} and {} are the same point", i + 1, k + 1);
  for (std::size_t i = 0; i < count; ++i) {
    const Vec2 before = polygon[i] - corner(polygon, i + count - 1);
    const Vec2 after = corner(polygon, i + 1) - polygon[i];
    const bool turns_back =
        before.dot(after) < 0 &&
        std::abs(cross(before, after)) <= kSame_mm * std::max(before.norm(), after.norm());
    if (turns_back && count > 3) return fmt::format("it turns back on itself at corner {}", i + 1);
  }
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t k = i + 2; k < count; ++k) {
      if (i == 0 && k == count - 1) continue;  // neighbours
      if (meet(polygon[i], corner(polygon, i + 1), polygon[k], corner(polygon, k + 1)))
        return fmt::format("its sides from corner {} and corner {} meet", i + 1, k + 1);
    }
  if (std::abs(signed_area_mm2(polygon)) < kLeastArea_mm2) return "it has no area";
  return {};
}

Polygon counter_clockwise(Polygon polygon) {
  if (signed_area_mm2(polygon) < 0) std::reverse(polygon.begin(), polygon.end());
  return polygon;
}

Polygon convex_hull(std::vector<Vec2> points) {
  std::sort(points.begin(), points.end(), [](const Vec2& a, const Vec2& b) {
    return a.x() < b.x() || (a.x() == b.x() && a.y() < b.y());
  });
  points.erase(std::unique(points.begin(), points.end()), points.end());
  if (points.size() < 3) return points;
  Polygon hull;
  const auto add = [&hull](const Vec2& point, std::size_t keep) {
    while (hull.size() >= keep + 2 &&
           cross(hull.back() - hull[hull.size() - 2], point - hull.back()) <= 0)
      hull.pop_back();
    hull.push_back(point);
  };
  for (const Vec2& point : points) add(point, 0);
  const std::size_t lower = hull.size() - 1;
  for (std::size_t i = points.size() - 1; i-- > 0;) add(points[i], lower);
  hull.pop_back();
  return hull;
}

bool contains(const Polygon& polygon, const Vec2& at) {
  bool inside = false;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec2& a = polygon[i];
    const Vec2& b = corner(polygon, i + 1);
    if ((a.y() > at.y()) == (b.y() > at.y())) continue;
    const double x = a.x() + (at.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x());
    if (at.x() < x) inside = !inside;
  }
  return inside;
}

Vec2 nearest_on_border(const Polygon& polygon, const Vec2& at) {
  Vec2 nearest = Vec2::Zero();
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec2 here = nearest_on(polygon[i], corner(polygon, i + 1), at);
    const double squared = (here - at).squaredNorm();
    if (squared >= least) continue;
    least = squared;
    nearest = here;
  }
  return nearest;
}

namespace {

// Where the stretch from a to b meets the border, as shares of it, its ends among them.
std::vector<double> cuts_of(const Polygon& polygon, const Vec2& a, const Vec2& b) {
  std::vector<double> cuts{0, 1};
  const Vec2 along = b - a;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec2& from = polygon[i];
    const Vec2 side = corner(polygon, i + 1) - from;
    const double across = cross(along, side);
    if (across == 0) continue;  // the sides beside it cut it
    const double at = cross(from - a, side) / across;
    const double on_side = cross(from - a, along) / across;
    if (at > 0 && at < 1 && on_side >= -kSame_mm && on_side <= 1 + kSame_mm) cuts.push_back(at);
  }
  std::sort(cuts.begin(), cuts.end());
  return cuts;
}

}  // namespace

std::vector<Stretch> pieces_within(const Polygon& polygon, const Vec2& a, const Vec2& b) {
  const std::vector<double> cuts = cuts_of(polygon, a, b);
  std::vector<Stretch> pieces;
  for (std::size_t i = 0; i + 1 < cuts.size(); ++i)
    if (contains(polygon, a + (cuts[i] + cuts[i + 1]) / 2 * (b - a)))
      pieces.push_back({a + cuts[i] * (b - a), a + cuts[i + 1] * (b - a)});
  return pieces;
}

double depth_within(const Polygon& polygon, const Vec2& a, const Vec2& b) {
  const std::vector<double> cuts = cuts_of(polygon, a, b);
  double deepest = 0;
  const auto look = [&](double at) {
    const Vec2 point = a + at * (b - a);
    if (contains(polygon, point))
      deepest = std::max(deepest, (nearest_on_border(polygon, point) - point).norm());
  };
  look(0);
  look(1);
  for (std::size_t i = 0; i + 1 < cuts.size(); ++i) look((cuts[i] + cuts[i + 1]) / 2);
  return deepest;
}

Vec2 inner_point(const Polygon& polygon) {
  Vec2 best = polygon[0];
  double deepest = -1;
  const auto consider = [&](const Vec2& at) {
    if (!contains(polygon, at)) return;
    const double depth = (nearest_on_border(polygon, at) - at).norm();
    if (depth <= deepest) return;
    deepest = depth;
    best = at;
  };
  // Half way across at the height of every corner and between the heights of two: one at least lies
  // within.
  std::vector<double> heights;
  for (const Vec2& at : polygon) heights.push_back(at.y());
  std::sort(heights.begin(), heights.end());
  for (std::size_t i = 0; i + 1 < heights.size(); ++i) {
    const double y = (heights[i] + heights[i + 1]) / 2;
    std::vector<double> crossings;
    for (std::size_t k = 0; k < polygon.size(); ++k) {
      const Vec2& a = polygon[k];
      const Vec2& b = corner(polygon, k + 1);
      if ((a.y() > y) != (b.y() > y))
        crossings.push_back(a.x() + (y - a.y()) / (b.y() - a.y()) * (b.x() - a.x()));
    }
    std::sort(crossings.begin(), crossings.end());
    for (std::size_t k = 0; k + 1 < crossings.size(); k += 2)
      consider(Vec2((crossings[k] + crossings[k + 1]) / 2, y));
  }
  return best;
}

Eigen::AlignedBox2d bounding_box(const Polygon& polygon) {
  Eigen::AlignedBox2d box;
  for (const Vec2& at : polygon) box.extend(at);
  return box;
}

}  // namespace packmerger
