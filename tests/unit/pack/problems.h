// Packing problems for tests.
#pragma once

#include <utility>

#include "model/packing.h"
#include "unit/pack/shapes.h"

namespace packmerger::shapes {

// Equation (1) of the paper.
inline Cost paper_cost(double w = 0.75) {
  Cost cost;
  cost.evaluate = [w](const TrayMeasure& m) {
    return w * m.size_mm.prod() + (1 - w) * m.support_mm3;
  };
  cost.lower_bound = cost.evaluate;
  return cost;
}

inline PackProblem problem_of(std::vector<Mesh> meshes, const Vec3& build_mm) {
  PackProblem problem;
  for (Mesh& mesh : meshes) {
    PackItem item;
    item.volume_mm3 = volume_mm3(mesh);
    item.surface = std::move(mesh);
    item.model = static_cast<int>(problem.items.size());
    problem.items.push_back(std::move(item));
  }
  problem.build_mm = build_mm;
  problem.rotation_step = radians(90);
  problem.search_grid_mm = 3;
  problem.tabu_patience = 2;
  problem.tabu_samples = 3;
  problem.cost = paper_cost();
  return problem;
}

// Parts that may stand anywhere, where height alone counts: the free search packs them.
inline PackProblem low_problem(std::vector<Mesh> meshes, const Vec3& build_mm, double gap_mm) {
  PackProblem problem = problem_of(std::move(meshes), build_mm);
  problem.gap_mm = gap_mm;
  problem.anywhere = true;
  problem.tabu_patience = 1;
  problem.cost.evaluate = [](const TrayMeasure& tray) { return tray.size_mm.z(); };
  problem.cost.lower_bound = problem.cost.evaluate;
  return problem;
}

}  // namespace packmerger::shapes
