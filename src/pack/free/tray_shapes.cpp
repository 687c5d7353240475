#include "pack/free/tray_shapes.h"

#include <algorithm>
#include <limits>

#include "base/parallel.h"
#include "pack/exact/exact_figures.h"
#include "pack/separate/separation.h"

namespace packmerger {
namespace {

constexpr double kReach_mm = 2.5;  // of the distances, beyond what parts keep apart

}  // namespace

TrayShapes shapes_of(const PackProblem& problem, const std::vector<PlacedPart>& parts) {
  std::vector<Mesh> meshes;
  std::vector<std::size_t> first_of(parts.size());
  for (std::size_t i = 0; i < parts.size(); ++i) {
    meshes.push_back(part_mesh(problem, parts[i]));
    first_of[i] = i;
    for (std::size_t j = 0; j < i && first_of[i] == i; ++j)
      if (meshes[j].points() == meshes[i].points() &&
          meshes[j].triangles() == meshes[i].triangles())
        first_of[i] = j;
  }
  std::vector<std::shared_ptr<const Shape>> shapes(parts.size());
  parallel_tasks(parts.size(), [&](std::size_t i) {
    if (first_of[i] == i)
      shapes[i] = std::make_shared<const Shape>(
          meshes[i], std::max(problem.gap_mm, kLeastApart_mm) + kReach_mm);
  });
  for (std::size_t i = 0; i < parts.size(); ++i) shapes[i] = shapes[first_of[i]];
  return shapes;
}

Pose own_frame(const Pose& pose, const Shape& shape) {
  return pose * Eigen::Translation3d(shape.centre);
}

void let_down(std::vector<Pose>& poses, const TrayShapes& shapes) {
  double lowest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < poses.size(); ++i)
    lowest = std::min(lowest, shapes[i]->surface.box(poses[i]).min().z());
  for (Pose& pose : poses) pose.translation().z() -= lowest;
}

}  // namespace packmerger
