#include "pack/exact/sweep.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "base/parallel.h"

namespace packmerger {
namespace {

constexpr double kMostAcross = 500;  // cells
constexpr std::uint64_t kStepsOfFacet = 200;

double cross_z(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

Vec2 flat(const Vec3& p) { return p.head<2>(); }

double turn(const Facet& facet) {
  return cross_z(flat(facet[1]) - flat(facet[0]), flat(facet[2]) - flat(facet[0]));
}

double height_at(const Facet& facet, const Vec2& p) {
  const Vec3 normal = (facet[1] - facet[0]).cross(facet[2] - facet[0]);
  const Vec2 away = p - flat(facet[0]);
  return facet[0].z() - (normal.x() * away.x() + normal.y() * away.y()) / normal.z();
}

// What two facets have in common, seen from above.
std::vector<Vec2> overlap(const Facet& a, const Facet& b) {
  std::vector<Vec2> polygon{flat(a[0]), flat(a[1]), flat(a[2])};
  for (std::size_t i = 0; i < 3 && !polygon.empty(); ++i) {
    const Vec2 from = flat(b[i]);
    const Vec2 along = flat(b[(i + 1) % 3]) - from;
    std::vector<Vec2> kept;
    for (std::size_t k = 0; k < polygon.size(); ++k) {
      const Vec2& here = polygon[k];
      const Vec2& next = polygon[(k + 1) % polygon.size()];
      const double side = cross_z(along, here - from);
      const double next_side = cross_z(along, next - from);
      if (side >= 0) kept.push_back(here);
      if ((side > 0 && next_side < 0) || (side < 0 && next_side > 0))
        kept.push_back(here + (next - here) * (side / (side - next_side)));
    }
    polygon = std::move(kept);
  }
  return polygon;
}

bool is_wide(const std::vector<Vec2>& polygon) {
  double twice_area = 0;
  double round = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec2& next = polygon[(i + 1) % polygon.size()];
    twice_area += cross_z(polygon[i] - polygon[0], next - polygon[0]);
    round += (next - polygon[i]).norm();
  }
  return twice_area > kTouch_mm * round;
}

// The difference in height is linear over what two facets have in common, so that it is greatest at
// a corner.
bool stands_above(const Facet& upper, const Facet& lower) {
  if (std::max({upper[0].z(), upper[1].z(), upper[2].z()}) <=
      std::min({lower[0].z(), lower[1].z(), lower[2].z()}) + kTouch_mm)
    return false;
  const std::vector<Vec2> common = overlap(lower, upper);
  if (!is_wide(common)) return false;
  return std::any_of(common.begin(), common.end(), [&](const Vec2& p) {
    return height_at(upper, p) - height_at(lower, p) > kTouch_mm;
  });
}

Facet moved_by(Facet facet, const Vec3& by) {
  for (Vec3& corner : facet) corner += by;
  return facet;
}

}  // namespace

Facing::Facing(const Mesh& mesh, bool up) {
  for (std::size_t i = 0; i < mesh.n_triangles(); ++i) {
    Facet facet = mesh.corners(i);
    const double twice_area = turn(facet);
    if (up ? twice_area <= 0 : twice_area >= 0) continue;
    if (!up) std::swap(facet[1], facet[2]);
    facets_.push_back(facet);
    for (const Vec3& p : facet) box_.extend(p);
  }
  if (facets_.empty()) return;
  const Vec2 size = box_.sizes().head<2>();
  cell_mm_ = std::max({std::sqrt(size.prod() / static_cast<double>(facets_.size())),
                       size.maxCoeff() / kMostAcross, kTouch_mm});
  width_ = 1 + static_cast<int>(size.x() / cell_mm_);
  height_ = 1 + static_cast<int>(size.y() / cell_mm_);
  cells_.resize(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_));
  for (int i = 0; i < static_cast<int>(facets_.size()); ++i)
    for_cells(*this, facets_[static_cast<std::size_t>(i)],
              [&](std::vector<int>& cell) { cell.push_back(i); });
}

StandingParts::StandingParts(const std::vector<Mesh>& parts, const Progress& progress)
    : StandingParts(parts, {}, std::vector<Pose>(parts.size(), Pose::Identity()), progress) {}

StandingParts::StandingParts(const std::vector<Mesh>& parts, std::vector<MovableSurface> surfaces,
                             std::vector<Pose> poses, const Progress& progress)
    : parts_(parts),
      progress_(progress),
      boxes_(parts.size()),
      tops_(parts.size()),
      bottoms_(parts.size()),
      surfaces_(std::move(surfaces)),
      poses_(std::move(poses)) {
  parallel_tasks(parts.size(), [&](std::size_t i) {
    progress_.check();
    boxes_[i] = bounding_box(parts_[i]);
    tops_[i].emplace(parts_[i], true);
    bottoms_[i].emplace(parts_[i], false);
  });
  for (const Mesh& part : parts_) effort_.spend(kStepsOfFacet * part.n_triangles());
}

bool StandingParts::is_under(int part, const Vec3& moved, int other) const {
  const Facing& bottom = *bottoms_[static_cast<std::size_t>(part)];
  const Facing& top = *tops_[static_cast<std::size_t>(other)];
  if (bottom.facets().empty() || top.facets().empty()) return false;
  const Box3 a = bottom.box().translated(moved);
  const Box3& b = top.box();
  if ((a.min().array() >= b.max().array()).any() ||
      (a.max().array() <= b.min().array()).head<2>().any())
    return false;
  effort_.spend(kStepsOfFacet * bottom.facets().size());
  std::atomic<bool> found{false};
  parallel_for(bottom.facets().size(), [&](std::size_t i) {
    if (found.load(std::memory_order_relaxed)) return;
    progress_.check();
    const Facet lower = moved_by(bottom.facets()[i], moved);
    top.near(lower, [&](const Facet& upper) {
      if (!found.load(std::memory_order_relaxed) && stands_above(upper, lower)) found = true;
    });
  });
  return found;
}

double StandingParts::distance_mm(int part, const Vec3& moved, int other, double enough) const {
  while (surfaces_.size() < parts_.size()) {
    progress_.check();
    surfaces_.emplace_back(parts_[surfaces_.size()]);
  }
  effort_.spend(kStepsOfDistance);
  const auto a = static_cast<std::size_t>(part);
  const auto b = static_cast<std::size_t>(other);
  return surface_distance_mm(surfaces_[a], Eigen::Translation3d(moved) * poses_[a], surfaces_[b],
                             poses_[b], enough);
}

std::optional<int> StandingParts::met_on_path(int part, const std::vector<int>& there,
                                              const std::vector<Vec3>& path) const {
  Vec3 place = Vec3::Zero();
  for (const Vec3& step : path) {
    const double length = step.norm();
    for (double gone = 0; gone < length;) {
      progress_.check();
      const Vec3 here = place + step * (gone / length);
      double room = length - gone + kLeastRoom_mm;
      for (const int other : there) {
        if (box(part).translated(here).exteriorDistance(box(other)) >= room) continue;
        room = std::min(room, distance_mm(part, here, other, room));
        if (room < kLeastRoom_mm) return other;
      }
      gone += room;
    }
    place += step;
  }
  return std::nullopt;
}

}  // namespace packmerger
