#include "shape/surface/unite_bodies.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "base/parallel.h"
#include "shape/surface/outer_hull.h"
#include "shape/surface/repair.h"
#include "shape/surface/surface_query.h"

namespace packmerger {
namespace {

// Between sheets that would touch, of the diagonal: as much as welding forgives.
constexpr double kGap = 1e-6;
// What is enclosed twice and less than this part of the volume only touches.
constexpr double kTouching = 1e-5;
// What changes more than this of the volume or the area is told as a change of the shape.
constexpr double kChanged = 0.01;
// Points at which the old surface and the new one have to agree, along each side of the box; beside
// a surface, nearer than this part of the diagonal, they need not.
constexpr int kLattice = 16;
constexpr double kBeside = 1e-4;
// How often what rounding made cross anew is cut again: mostly once or twice.
constexpr int kMostCuts = 6;

// Whether hull is around what mesh winds around, asked at points all over the box. They are off its
// middle and its round fractions, where models have their faces.
bool is_around_the_same(const Mesh& hull, const Mesh& mesh, const Progress& progress) {
  const Box3 box = bounding_box(mesh);
  const double beside_mm = kBeside * box.diagonal().norm();
  const Box3 other = bounding_box(hull);
  if ((box.min() - other.min()).norm() > beside_mm || (box.max() - other.max()).norm() > beside_mm)
    return false;
  const SurfaceQuery of_hull(hull);
  const SurfaceQuery of_mesh(mesh);
  std::vector<char> differs(kLattice * kLattice * kLattice, 0);
  parallel_for(differs.size(), [&](std::size_t i) {
    progress.check();
    const auto n = static_cast<int>(i);
    const Vec3 steps(n % kLattice, n / kLattice % kLattice, n / (kLattice * kLattice));
    const Vec3 part = (steps + Vec3(0.4153, 0.5347, 0.4729)) / kLattice;
    const Vec3 point = box.min() + part.cwiseProduct(box.sizes());
    const bool is_matter = of_mesh.winding_number(point) != 0;
    if ((of_hull.winding_number(point) != 0) != is_matter)
      differs[i] = of_mesh.distance_mm(point) > beside_mm ? 1 : 0;
  });
  return std::find(differs.begin(), differs.end(), 1) == differs.end();
}

std::string percent(double part) {
  return part < kChanged ? "less than 1 %" : std::to_string(std::lround(100 * part)) + " %";
}

}  // namespace

Mesh unite_bodies(Mesh mesh, Warnings& warnings, const Progress& progress) {
  if (!self_intersects(mesh)) return mesh;
  progress.report("uniting", 0);
  const Progress silent({}, progress.cancelled());
  const double gap_mm = kGap * bounding_box(mesh).diagonal().norm();
  auto hull = outer_hull(mesh, gap_mm, silent);
  if (!hull || !is_around_the_same(*hull, mesh, silent)) {
    warnings.push_back(
        {"shape_changed",
         "The model's surface crosses itself and could not be made one: where bodies "
         "overlap, matter is counted twice"});
    return mesh;
  }
  const double volume = std::abs(volume_mm3(*hull) / volume_mm3(mesh) - 1);
  if (volume < kTouching) return mesh;
  for (int cuts = 1; cuts < kMostCuts && self_intersects(*hull); ++cuts) {
    auto next = outer_hull(*hull, gap_mm, silent);
    if (!next || !is_around_the_same(*next, mesh, silent)) break;
    hull = std::move(next);
  }
  const double area = std::abs(area_mm2(*hull) / area_mm2(mesh) - 1);
  const std::string told =
      "Bodies of the model overlap and were made one, as slicers do: counted once, its volume "
      "differs by " +
      percent(volume) + " and its area by " + percent(area);
  if (std::max(volume, area) > kChanged)
    warnings.push_back({"shape_changed", told});
  else
    warnings.push_back({"united", told});
  return std::move(*hull);
}

}  // namespace packmerger
