#include "shape/surface/surface_query.h"

#include <array>
#include <limits>
#include <utility>
#include <vector>

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Simple_cartesian.h>

namespace packmerger {
namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Triangle = Kernel::Triangle_3;
using Primitive = CGAL::AABB_triangle_primitive<Kernel, std::vector<Triangle>::const_iterator>;
using AabbTree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>>;

Kernel::Point_3 to_cgal(const Vec3& p) { return {p.x(), p.y(), p.z()}; }
Vec3 from_cgal(const Kernel::Point_3& p) { return {p.x(), p.y(), p.z()}; }

// Directions that no modelled edge or face is likely to be parallel to.
const std::array<Vec3, 3> kDirections = {
    Vec3(0.5127, 0.3041, 0.8029), Vec3(-0.2963, 0.8717, 0.3903), Vec3(0.7211, -0.6519, -0.2347)};

}  // namespace

struct SurfaceQuery::Tree {
  std::vector<Triangle> triangles;
  AabbTree aabb;

  Vec3 normal(int triangle) const {
    const Triangle& t = triangles[static_cast<std::size_t>(triangle)];
    return (from_cgal(t[1]) - from_cgal(t[0])).cross(from_cgal(t[2]) - from_cgal(t[0]));
  }
  int index(const Primitive::Id& id) const { return static_cast<int>(id - triangles.begin()); }

  int winding(const Vec3& point, const Vec3& direction) const {
    std::vector<Primitive::Id> hits;
    const Vec3 far = point + direction;
    aabb.all_intersected_primitives(Kernel::Ray_3(to_cgal(point), to_cgal(far)),
                                    std::back_inserter(hits));
    int sum = 0;
    for (const auto& hit : hits) sum += normal(index(hit)).dot(direction) > 0 ? 1 : -1;
    return sum;
  }
};

SurfaceQuery::SurfaceQuery(const TriangleView& surface) : tree_(std::make_unique<Tree>()) {
  tree_->triangles.reserve(surface.triangles.size());
  for (const auto& [a, b, c] : surface.triangles)
    tree_->triangles.emplace_back(to_cgal(surface.points[a]), to_cgal(surface.points[b]),
                                  to_cgal(surface.points[c]));
  tree_->aabb.insert(tree_->triangles.cbegin(), tree_->triangles.cend());
  tree_->aabb.build();
  tree_->aabb.accelerate_distance_queries();  // now, since later it would not be thread-safe
}

SurfaceQuery::SurfaceQuery(SurfaceQuery&&) noexcept = default;
SurfaceQuery& SurfaceQuery::operator=(SurfaceQuery&&) noexcept = default;
SurfaceQuery::~SurfaceQuery() = default;

SurfaceQuery::Nearest SurfaceQuery::nearest(const Vec3& point) const {
  const auto [on, id] = tree_->aabb.closest_point_and_primitive(to_cgal(point));
  const Vec3 found = from_cgal(on);
  return {found, tree_->index(id), (found - point).norm()};
}

int SurfaceQuery::winding_number(const Vec3& point) const {
  // A ray through an edge counts it twice or not at all; two of three directions agree.
  const int first = tree_->winding(point, kDirections[0]);
  const int second = tree_->winding(point, kDirections[1]);
  if (first == second) return first;
  const int third = tree_->winding(point, kDirections[2]);
  return third == second ? second : first;
}

std::optional<double> SurfaceQuery::ray_mm(const Vec3& from, const Vec3& direction) const {
  constexpr double kOwnSurface = 1e-9;
  std::vector<AabbTree::Intersection_and_primitive_id<Kernel::Ray_3>::Type> hits;
  tree_->aabb.all_intersections(Kernel::Ray_3(to_cgal(from), to_cgal(from + direction)),
                                std::back_inserter(hits));
  double nearest = std::numeric_limits<double>::infinity();
  for (const auto& hit : hits)
    if (const auto* point = boost::get<Kernel::Point_3>(&hit.first)) {
      const double along = (from_cgal(*point) - from).dot(direction);
      if (along > kOwnSurface && along < nearest) nearest = along;
    }
  if (nearest == std::numeric_limits<double>::infinity()) return std::nullopt;
  return nearest;
}

}  // namespace packmerger
