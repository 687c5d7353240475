#include "model/plate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

namespace packmerger {
namespace {

using Corners = std::array<Vec2, 3>;

// What lies between a polygon and its hull: one polygon for each run of corners off the hull.
std::vector<Polygon> pockets(const Polygon& outline, const Polygon& hull) {
  const std::size_t count = outline.size();
  const auto on_hull = [&](std::size_t i) {
    return std::find(hull.begin(), hull.end(), outline[i % count]) != hull.end();
  };
  std::size_t first = 0;
  while (!on_hull(first)) ++first;
  std::vector<Polygon> found;
  Polygon run;
  for (std::size_t i = first; i <= first + count; ++i) {
    run.push_back(outline[i % count]);
    if (!on_hull(i)) continue;
    // Corners in the middle of a side of the hull leave nothing between them.
    if (run.size() > 2 && std::abs(signed_area_mm2(run)) > 0)
      found.push_back(counter_clockwise(std::move(run)));
    run = {outline[i % count]};
  }
  return found;
}

bool is_inside(const Corners& triangle, const Vec2& at) {
  bool left = true;
  bool right = true;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec2 side = triangle[(i + 1) % 3] - triangle[i];
    const Vec2 to = at - triangle[i];
    const double turn = side.x() * to.y() - side.y() * to.x();
    left = left && turn >= 0;
    right = right && turn <= 0;
  }
  return left || right;
}

// The points of a convex polygon, counter-clockwise, at which outward · p <= offset.
Polygon clipped(const Polygon& polygon, const Vec2& outward, double offset) {
  Polygon kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec2& from = polygon[i];
    const Vec2& to = polygon[(i + 1) % polygon.size()];
    const double from_over = outward.dot(from) - offset;
    const double to_over = outward.dot(to) - offset;
    if (from_over <= 0) kept.push_back(from);
    if ((from_over < 0 && to_over > 0) || (from_over > 0 && to_over < 0))
      kept.push_back(from + from_over / (from_over - to_over) * (to - from));
  }
  return kept;
}

// What is nearer than margin_mm to a side, and a little more.
Polygon grown_side(const Vec2& a, const Vec2& b, double margin_mm) {
  constexpr int kCorners = 8;
  const double reach_mm = margin_mm / std::cos(std::numbers::pi / kCorners);
  std::vector<Vec2> points;
  for (int i = 0; i < kCorners; ++i) {
    const double angle = 2 * std::numbers::pi * (i + 0.5) / kCorners;
    const Vec2 out = reach_mm * Vec2(std::cos(angle), std::sin(angle));
    points.push_back(a + out);
    points.push_back(b + out);
  }
  return convex_hull(std::move(points));
}

// A flat fan over a convex polygon.
TriangleSoup fan(const Polygon& hull) {
  TriangleSoup soup;
  for (const Vec2& at : hull) soup.points.emplace_back(at.x(), at.y(), 0);
  for (int i = 1; i + 1 < static_cast<int>(hull.size()); ++i)
    soup.triangles.push_back({0, i, i + 1});
  return soup;
}

Pose shifted_by(const Vec2& shift) { return Pose(Eigen::Translation3d(shift.x(), shift.y(), 0)); }

}  // namespace

Plate::Plate(const Polygon& outline, const std::vector<Polygon>& kept_out) {
  if (!outline.empty()) {
    hull_ = convex_hull(outline);
    for (std::size_t i = 0; i < hull_.size(); ++i) {
      const Vec2 side = hull_[(i + 1) % hull_.size()] - hull_[i];
      const Vec2 outward = Vec2(side.y(), -side.x()).normalized();
      sides_.push_back({outward, outward.dot(hull_[i])});
    }
    barred_ = pockets(counter_clockwise(outline), hull_);
  }
  for (const Polygon& area : kept_out) barred_.push_back(counter_clockwise(area));
  for (const Polygon& area : barred_) {
    boxes_.push_back(bounding_box(area));
    inner_points_.push_back(inner_point(area));
  }
}

Plate Plate::drawn_in(const Vec2& corner, double margin_mm) const {
  Polygon hull = hull_;
  for (const Side& side : sides_) hull = clipped(hull, side.outward, side.offset - margin_mm);
  std::vector<Polygon> barred = barred_;
  if (hull.size() < 3 || std::abs(signed_area_mm2(hull)) <= 0) {
    if (!hull_.empty()) barred.push_back(hull_);  // the margin leaves nothing
    hull = hull_;
  }
  if (margin_mm > 0)
    for (const Polygon& area : barred_)
      for (std::size_t i = 0; i < area.size(); ++i)
        barred.push_back(grown_side(area[i], area[(i + 1) % area.size()], margin_mm));
  for (Vec2& at : hull) at -= corner;
  for (Polygon& area : barred)
    for (Vec2& at : area) at -= corner;
  return {hull, barred};
}

Plate::Wall Plate::nearest_wall(const Vec2& at) const {
  Wall nearest = nearest_barred(at);
  for (const Side& side : sides_) {
    const double clearance = side.offset - side.outward.dot(at);
    if (clearance < nearest.clearance_mm) nearest = {clearance, -side.outward};
  }
  return nearest;
}

Plate::Wall Plate::nearest_barred(const Vec2& at) const {
  Wall nearest;
  for (const Polygon& area : barred_) {
    const Vec2 border = nearest_on_border(area, at);
    const double distance = (border - at).norm();
    const double sign = contains(area, at) ? -1 : 1;
    if (sign * distance >= nearest.clearance_mm) continue;
    nearest.clearance_mm = sign * distance;
    nearest.away = distance > 0 ? Vec2(sign / distance * (at - border)) : Vec2::Zero();
  }
  return nearest;
}

double Plate::breach_mm(const TriangleView& surface, const Pose& pose) const {
  if (is_whole()) return 0;
  std::vector<Vec2> points;
  points.reserve(surface.points.size());
  Eigen::AlignedBox2d box;
  for (const Vec3& point : surface.points) {
    points.emplace_back((pose * point).head<2>());
    box.extend(points.back());
  }
  if (points.empty()) return 0;
  double breach = 0;
  for (const Side& side : sides_) {
    const Vec2 farthest(side.outward.x() > 0 ? box.max().x() : box.min().x(),
                        side.outward.y() > 0 ? box.max().y() : box.min().y());
    if (side.outward.dot(farthest) <= side.offset) continue;
    for (const Vec2& point : points)
      breach = std::max(breach, side.outward.dot(point) - side.offset);
  }
  for (std::size_t i = 0; i < barred_.size(); ++i) {
    if (!boxes_[i].intersects(box)) continue;
    const Polygon& area = barred_[i];
    const double inner_depth =
        (nearest_on_border(area, inner_points_[i]) - inner_points_[i]).norm();
    for (const auto& [a, b, c] : surface.triangles) {
      const Corners corners{points[static_cast<std::size_t>(a)],
                            points[static_cast<std::size_t>(b)],
                            points[static_cast<std::size_t>(c)]};
      Eigen::AlignedBox2d of_triangle(corners[0]);
      of_triangle.extend(corners[1]).extend(corners[2]);
      if (!boxes_[i].intersects(of_triangle)) continue;
      // Where no side of it enters the area, it covers all of the area or nothing.
      if (is_inside(corners, inner_points_[i])) breach = std::max(breach, inner_depth);
      for (std::size_t k = 0; k < 3; ++k)
        breach = std::max(breach, depth_within(area, corners[k], corners[(k + 1) % 3]));
    }
  }
  return breach;
}

bool Plate::surely_clear(const Box3& box) const {
  const Eigen::AlignedBox2d flat(box.min().head<2>().eval(), box.max().head<2>().eval());
  for (const Side& side : sides_) {
    const Vec2 farthest(side.outward.x() > 0 ? flat.max().x() : flat.min().x(),
                        side.outward.y() > 0 ? flat.max().y() : flat.min().y());
    if (side.outward.dot(farthest) > side.offset) return false;
  }
  return std::none_of(boxes_.begin(), boxes_.end(),
                      [&](const Eigen::AlignedBox2d& barred) { return barred.intersects(flat); });
}

// Where the box touches walls on two sides, seen as boxes, within the range of shifts.
std::vector<Vec2> Plate::touching(const Eigen::AlignedBox2d& box,
                                  const Eigen::AlignedBox2d& range) const {
  std::array<std::vector<double>, 2> along;
  for (int axis = 0; axis < 2; ++axis) {
    std::vector<double>& shifts = along[static_cast<std::size_t>(axis)];
    shifts = {range.min()[axis], range.max()[axis]};
    for (const Eigen::AlignedBox2d& barred : boxes_) {
      shifts.push_back(barred.max()[axis] - box.min()[axis]);
      shifts.push_back(barred.min()[axis] - box.max()[axis]);
    }
    std::erase_if(shifts, [&](double shift) {
      return shift < range.min()[axis] || shift > range.max()[axis];
    });
    std::sort(shifts.begin(), shifts.end());
  }
  std::vector<Vec2> found;
  for (const double y : along[1])
    for (const double x : along[0]) found.emplace_back(x, y);
  return found;
}

std::optional<Vec2> Plate::spot_for(const TriangleView& surface, const Vec2& room_mm) const {
  constexpr int kLattice = 15;
  std::vector<Vec2> points;
  points.reserve(surface.points.size());
  for (const Vec3& point : surface.points) points.emplace_back(point.head<2>());
  const Polygon hull = convex_hull(std::move(points));
  const Eigen::AlignedBox2d box = bounding_box(hull);
  // The shifts within the rectangle and the plate's hull are a convex polygon.
  const Vec2 low = -box.min();
  const Vec2 high = (room_mm - box.max()).array() + kWallTolerance_mm / 2;
  if (hull.empty() || (high - low).minCoeff() < 0) return std::nullopt;
  Polygon shifts{low, Vec2(high.x(), low.y()), high, Vec2(low.x(), high.y())};
  for (const Side& side : sides_) {
    double farthest = -std::numeric_limits<double>::infinity();
    for (const Vec2& point : hull) farthest = std::max(farthest, side.outward.dot(point));
    shifts = clipped(shifts, side.outward, side.offset - farthest + kWallTolerance_mm / 2);
    if (shifts.empty()) return std::nullopt;
  }
  Vec2 middle = Vec2::Zero();
  for (const Vec2& shift : shifts) middle += shift / static_cast<double>(shifts.size());
  if (barred_.empty()) return middle;
  std::vector<Vec2> coarse;
  const Eigen::AlignedBox2d range = bounding_box(shifts);
  for (int y = 0; y < kLattice; ++y)
    for (int x = 0; x < kLattice; ++x) {
      const Vec2 at = range.min() + range.sizes().cwiseProduct(Vec2(x, y)) / (kLattice - 1);
      if (contains(shifts, at)) coarse.push_back(at);
    }
  coarse.insert(coarse.end(), shifts.begin(), shifts.end());
  coarse.push_back(middle);
  const auto first_clear = [&](const TriangleView& looked_at,
                               const std::vector<Vec2>& tried) -> std::optional<Vec2> {
    for (const Vec2& shift : tried)
      if (breach_mm(looked_at, shifted_by(shift)) <= kWallTolerance_mm) return shift;
    return std::nullopt;
  };
  // The hull is looked at first: where it stands clear the surface does, and it is far smaller.
  const TriangleSoup of_hull = fan(hull);
  if (const auto spot = first_clear(TriangleView(of_hull), coarse)) return spot;
  if (const auto spot = first_clear(TriangleView(of_hull), touching(box, range))) return spot;
  return first_clear(surface, coarse);
}

}  // namespace packmerger
