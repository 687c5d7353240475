#include "pack/free/part_shapes.h"

#include <algorithm>
#include <atomic>
#include <limits>

#include "base/parallel.h"
#include "pack/exact/exact_figures.h"
#include "pack/separate/separation.h"

namespace packmerger {
namespace {

constexpr double kReach_mm = 2.5;  // of the distances, beyond what parts keep apart

}  // namespace

TrayParts parts_of(const Packing& packing, int tray) {
  TrayParts here;
  std::vector<int> numbers(packing.parts.size(), -1);
  for (std::size_t i = 0; i < packing.parts.size(); ++i) {
    if (packing.parts[i].tray != tray) continue;
    numbers[i] = static_cast<int>(here.parts.size());
    here.indices.push_back(i);
    here.parts.push_back(packing.parts[i]);
  }
  for (const int part : packing.removal_order)
    if (const int number = numbers[static_cast<std::size_t>(part)]; number >= 0)
      here.order.push_back(number);
  return here;
}

std::vector<std::shared_ptr<const Shape>> shapes_of(const PackProblem& problem,
                                                    const std::vector<PlacedPart>& parts,
                                                    Pace& pace) {
  std::vector<Mesh> meshes;
  std::vector<std::size_t> first_of(parts.size());
  for (std::size_t i = 0; i < parts.size(); ++i) {
    pace.tick();
    meshes.push_back(part_mesh(problem, parts[i]));
    first_of[i] = i;
    for (std::size_t j = 0; j < i && first_of[i] == i; ++j)
      if (meshes[j].points() == meshes[i].points() &&
          meshes[j].triangles() == meshes[i].triangles())
        first_of[i] = j;
  }
  std::vector<std::shared_ptr<const Shape>> shapes(parts.size());
  std::atomic<bool> are_whole = true;
  parallel_tasks(parts.size(), [&](std::size_t i) {
    if (first_of[i] != i || !are_whole) return;
    pace.tick();
    if (pace.passed() >= 1)
      are_whole = false;
    else
      shapes[i] = std::make_shared<const Shape>(
          meshes[i], std::max(problem.gap_mm, kLeastApart_mm) + kReach_mm);
  });
  if (!are_whole) return {};
  for (std::size_t i = 0; i < parts.size(); ++i) shapes[i] = shapes[first_of[i]];
  return shapes;
}

Pose own_frame(const Pose& pose, const Shape& shape) {
  return pose * Eigen::Translation3d(shape.centre);
}

Pose part_frame(const Pose& pose, const Shape& shape) {
  return pose * Eigen::Translation3d(-shape.centre);
}

void let_down(std::vector<Pose>& poses, const std::vector<std::shared_ptr<const Shape>>& shapes) {
  double lowest_mm = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < poses.size(); ++i)
    lowest_mm = std::min(lowest_mm, shapes[i]->surface.box(poses[i]).min().z());
  for (Pose& pose : poses) pose.translation().z() -= lowest_mm;
}

}  // namespace packmerger
