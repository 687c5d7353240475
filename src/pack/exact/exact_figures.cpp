#include "pack/exact/exact_figures.h"

#include <algorithm>

#include "pack/exact/exact_gap.h"
#include "pack/maps/columns.h"

namespace packmerger {
namespace {

constexpr double kTold_mm = 0.1;  // above the gap asked for: what lies further apart is not told

}  // namespace

Mesh part_mesh(const PackProblem& problem, const PlacedPart& part) {
  std::vector<const Mesh*> members;
  for (const int item : part.items)
    members.push_back(&problem.items[static_cast<std::size_t>(item)].surface);
  return united(members);
}

Mesh placed_mesh(const PackProblem& problem, const PlacedPart& part) {
  return transformed(part_mesh(problem, part), part.pose);
}

void keep_inside(PlacedPart& part, const PackProblem& problem) {
  for (int round = 0; round < 2; ++round) {
    const Box3 box = bounding_box(placed_mesh(problem, part));
    const Vec3 under = (-box.min()).cwiseMax(0.0);
    const Vec3 over = (box.max() - problem.build_mm).cwiseMax(0.0);
    part.pose.translation() += under - over;
  }
}

TrayMeasure measured(const PackProblem& problem, const std::vector<Mesh>& placed,
                     double material_mm3) {
  TrayMeasure figures;
  Box3 box;
  for (const Mesh& surface : placed) box.extend(bounding_box(surface));
  figures.size_mm = Vec3(box.sizes().x(), box.sizes().y(), box.max().z());
  const ColumnSupport support =
      column_support(placed, problem.grid_mm / 2, problem.support_angle, 0);
  figures.support_mm3 = support.below + support.inside;
  figures.material_mm3 = material_mm3;
  figures.parts = static_cast<int>(placed.size());
  return figures;
}

void measure(const PackProblem& problem, Packing& packing) {
  int trays = 0;
  for (const PlacedPart& part : packing.parts) trays = std::max(trays, part.tray + 1);
  packing.trays.clear();
  packing.cost = 0;
  for (int tray = 0; tray < trays; ++tray) {
    std::vector<Mesh> placed;
    double material_mm3 = 0;
    for (const PlacedPart& part : packing.parts) {
      if (part.tray != tray) continue;
      placed.push_back(placed_mesh(problem, part));
      for (const int item : part.items)
        material_mm3 += problem.items[static_cast<std::size_t>(item)].volume_mm3;
    }
    packing.trays.push_back(measured(problem, placed, material_mm3));
    packing.cost += problem.cost.evaluate(packing.trays.back());
  }
}

double least_gap_mm(const Packing& packing, const PackProblem& problem) {
  double least = problem.gap_mm + kTold_mm;
  for (int tray = 0; tray < static_cast<int>(packing.trays.size()); ++tray) {
    std::vector<Mesh> meshes;
    for (const PlacedPart& part : packing.parts)
      if (part.tray == tray) meshes.push_back(placed_mesh(problem, part));
    least = std::min(least, least_gap_mm(meshes, least));
  }
  return least;
}

}  // namespace packmerger
