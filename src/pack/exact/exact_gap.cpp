#include "pack/exact/exact_gap.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <optional>

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/math/bv/OBBRSS.h>
#include <fcl/narrowphase/distance.h>

#include "base/parallel.h"

namespace packmerger {
namespace {

// The solid angle of all faces seen from p over 4π: 1 within the matter, 0 outside of it.
double winding(const Mesh& mesh, const Vec3& p) {
  double sum = 0;
  for (std::size_t i = 0; i < mesh.n_triangles(); ++i) {
    const auto corner = mesh.corners(i);
    const Vec3 a = corner[0] - p;
    const Vec3 b = corner[1] - p;
    const Vec3 c = corner[2] - p;
    const double la = a.norm();
    const double lb = b.norm();
    const double lc = c.norm();
    sum += 2 * std::atan2(a.dot(b.cross(c)),
                          la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return sum / (4 * std::numbers::pi);
}

// Surfaces that do not meet are one in the other or apart; each piece of a surface must be asked,
// and any of its points will do.
bool lies_within(const Mesh& inner, const Mesh& outer) {
  std::vector<bool> seen(inner.n_triangles(), false);
  std::vector<std::size_t> open;
  for (std::size_t start = 0; start < seen.size(); ++start) {
    if (seen[start]) continue;
    if (winding(outer, inner.corners(start).front()) > 0.5) return true;
    open.assign(1, start);
    seen[start] = true;
    while (!open.empty()) {
      const std::size_t triangle = open.back();
      open.pop_back();
      for (const int beside : inner.neighbours()[triangle]) {
        if (beside < 0) continue;
        const auto next = static_cast<std::size_t>(beside);
        if (seen[next]) continue;
        seen[next] = true;
        open.push_back(next);
      }
    }
  }
  return false;
}

}  // namespace

struct MovableSurface::Tree {
  fcl::BVHModel<fcl::OBBRSSd> triangles;
};

MovableSurface::MovableSurface(const Mesh& mesh) : mesh_(mesh) {
  std::vector<fcl::Triangle> triangles;
  triangles.reserve(mesh.n_triangles());
  for (const auto& [a, b, c] : mesh.triangles())
    triangles.emplace_back(static_cast<std::size_t>(a), static_cast<std::size_t>(b),
                           static_cast<std::size_t>(c));
  auto tree = std::make_shared<Tree>();
  tree->triangles.beginModel();
  tree->triangles.addSubModel(mesh.points(), triangles);
  tree->triangles.endModel();
  tree_ = std::move(tree);
}

Box3 MovableSurface::box(const Pose& at) const {
  Box3 box;
  for (const Vec3& point : mesh_.points()) box.extend(at * point);
  return box;
}

double surface_distance_mm(const MovableSurface& a, const Pose& at_a, const MovableSurface& b,
                           const Pose& at_b, double enough) {
  fcl::DistanceRequestd request;
  fcl::DistanceResultd result;
  // What is known already: branches that are further apart are skipped.
  result.min_distance = std::min(enough, std::numeric_limits<double>::max());
  return std::clamp(
      fcl::distance(&a.tree_->triangles, at_a, &b.tree_->triangles, at_b, request, result), 0.0,
      enough);
}

double least_gap_mm(const std::vector<Mesh>& parts, double enough) {
  std::vector<Box3> boxes;
  for (const Mesh& part : parts) boxes.push_back(bounding_box(part));
  std::vector<std::pair<std::size_t, std::size_t>> near;
  std::vector<bool> is_near(parts.size(), false);
  for (std::size_t i = 0; i < parts.size(); ++i)
    for (std::size_t j = i + 1; j < parts.size(); ++j)
      if (boxes[i].exteriorDistance(boxes[j]) < enough) {
        near.emplace_back(i, j);
        is_near[i] = is_near[j] = true;
      }
  std::vector<std::optional<MovableSurface>> surfaces(parts.size());
  parallel_tasks(parts.size(), [&](std::size_t i) {
    if (is_near[i]) surfaces[i].emplace(parts[i]);
  });
  const Pose here = Pose::Identity();
  std::vector<double> gaps(near.size());
  parallel_tasks(near.size(), [&](std::size_t k) {
    const auto& [i, j] = near[k];
    gaps[k] = surface_distance_mm(*surfaces[i], here, *surfaces[j], here, enough);
    if (gaps[k] > 0 && boxes[i].intersects(boxes[j]) &&
        (lies_within(parts[i], parts[j]) || lies_within(parts[j], parts[i])))
      gaps[k] = 0;
  });
  return gaps.empty() ? enough : *std::min_element(gaps.begin(), gaps.end());
}

}  // namespace packmerger
