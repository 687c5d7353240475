#include "shape/solid/pockets.h"

#include <algorithm>
#include <cmath>

#include "shape/read/soup.h"
#include "shape/surface/distance_grid.h"

namespace packmerger {
namespace {

constexpr double kMostVoxels = 2e6;      // in the model's box: they are few near its surface
constexpr double kLeastShare = 1.0 / 8;  // voxel, of the ball
constexpr double kLeast_mm3 = 1e-6;      // less is a crumb of rounding

std::size_t inward_components(const TriangleView& surface) {
  const std::vector<TriangleSoup> components = split_components(surface);
  return static_cast<std::size_t>(std::count_if(
      components.begin(), components.end(),
      [](const TriangleSoup& component) { return signed_volume_mm3(component) < -kLeast_mm3; }));
}

}  // namespace

std::size_t sealed_cavities(const Mesh& mesh) { return inward_components(mesh); }

std::size_t pockets(const Mesh& mesh, double ball_mm, const Progress& progress) {
  const std::size_t sealed = sealed_cavities(mesh);
  const double voxel_mm =
      std::max(ball_mm * kLeastShare, std::cbrt(bounding_box(mesh).volume() / kMostVoxels));
  // The ball's centre may be where nothing is nearer than its radius.
  DistanceGrid grid(mesh, voxel_mm, 2 * voxel_mm, ball_mm / 2 + 2 * voxel_mm, NarrowSheets::kCount,
                    progress);
  const std::optional<TriangleSoup> reached = grid.level(ball_mm / 2, progress);
  return std::max(sealed, reached ? inward_components(*reached) : 0);
}

}  // namespace packmerger
