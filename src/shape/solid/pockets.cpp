#include "shape/solid/pockets.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "shape/read/soup.h"
#include "shape/surface/distance_grid.h"

namespace packmerger {
namespace {

constexpr double kMostVoxels = 7e5;      // in the model's box: they are few near its surface
constexpr double kLeastShare = 1.0 / 8;  // voxel, of the opening
constexpr double kLeast_mm3 = 1e-6;      // less is a crumb of rounding
constexpr double kWide = 1.8;            // openings: one alone is enough where it is so much wider
constexpr double kShut = 0.53;           // of an opening: its half, and a little
constexpr double kPlugApart = 0.1;       // of an opening: between a plug and the walls

std::vector<TriangleSoup> inward_components(const TriangleView& surface) {
  std::vector<TriangleSoup> components = split_components(surface);
  std::erase_if(components, [](const TriangleSoup& component) {
    return signed_volume_mm3(component) >= -kLeast_mm3;
  });
  return components;
}

// V − E + F, twice that: of a closed surface.
long twice_euler(const TriangleSoup& closed) {
  return 2 * static_cast<long>(closed.points.size()) - static_cast<long>(closed.triangles.size());
}

class Air {
 public:
  Air(const Mesh& mesh, double opening_mm, double reach_mm, const Progress& progress)
      : progress_(progress),
        grid_(mesh, voxel_mm(mesh, opening_mm), 2 * voxel_mm(mesh, opening_mm),
              reach_mm + 2 * voxel_mm(mesh, opening_mm), NarrowSheets::kCount, progress) {}

  // Round all places that are less than `distance_mm` from the mesh.
  TriangleSoup reached(double distance_mm) {
    return grid_.level(distance_mm, progress_).value_or(TriangleSoup{});
  }

 private:
  static double voxel_mm(const Mesh& mesh, double opening_mm) {
    return std::max(opening_mm * kLeastShare, std::cbrt(bounding_box(mesh).volume() / kMostVoxels));
  }

  const Progress& progress_;
  DistanceGrid grid_;
};

}  // namespace

std::size_t sealed_cavities(const Mesh& mesh) { return inward_components(mesh).size(); }

std::size_t keeping_cavities(const Mesh& mesh, double opening_mm, const Progress& progress) {
  if (const std::size_t sealed = sealed_cavities(mesh)) return sealed;
  // The centre of a ball may be where nothing is nearer than its radius.
  Air air(mesh, opening_mm, kWide * opening_mm / 2, progress);
  if (const auto shut = inward_components(air.reached(opening_mm / 2)).size()) return shut;
  const double shut_mm = kShut * opening_mm;
  std::size_t keeping = 0;
  for (TriangleSoup& chamber : inward_components(air.reached(kWide * opening_mm / 2))) {
    // Filled, it leaves a dent for each of its openings: each after the first was a handle.
    const double growth_mm = (kWide / 2 - kPlugApart) * opening_mm;
    Air round_chamber(closed_mesh(turned(std::move(chamber))), opening_mm, growth_mm, progress);
    TriangleSoup plugged{mesh.points(), mesh.triangles()};
    append(plugged, round_chamber.reached(growth_mm));
    Air round_plug(closed_mesh(std::move(plugged)), opening_mm, shut_mm, progress);
    const long handles =
        twice_euler(round_plug.reached(shut_mm)) - twice_euler(air.reached(shut_mm));
    if (handles < 4) ++keeping;
  }
  return keeping;
}

}  // namespace packmerger
