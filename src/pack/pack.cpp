#include "pack/pack.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "base/parallel.h"
#include "pack/columns.h"
#include "pack/exact_gap.h"
#include "pack/fill.h"
#include "pack/search.h"

namespace packmerger {
namespace {

constexpr double kGapTolerance_mm = 1e-6;
constexpr int kRepairs = 6;
constexpr std::size_t kPlacedConfigurations = 3;  // of the search's best, packed with all turns
constexpr int kPlaceCandidates = 32;

// One way to come to an answer, so that it can be repeated with more room between the parts.
struct Plan {
  std::vector<ItemSet> parts;
  Order order;
  Effort effort = Effort::kSearch;
};

void check_settings(const PackProblem& problem) {
  const auto refuse = [](const std::string& what, const char* hint) {
    throw Error(Fault::kUsage, what, hint);
  };
  if (problem.items.empty()) refuse("There is nothing to pack", "Give a model.");
  if (!(problem.grid_mm > 0) || !(problem.search_grid_mm > 0))
    refuse("The packer's grid must be above 0 mm", "Set grid_mm and search_grid_mm to 1 or so.");
  if (!(problem.gap_mm >= 0)) refuse("The gap must not be negative", "Set gap_mm to 0 or more.");
  if (!(problem.build_mm.minCoeff() > 0))
    refuse("The build volume is empty", "Set build_mm to the printer's size.");
  constexpr double kMostCells = 4e6;
  if (problem.build_mm.x() * problem.build_mm.y() / (problem.grid_mm * problem.grid_mm) >
          kMostCells ||
      problem.build_mm.head<2>().maxCoeff() / problem.grid_mm > 4000)
    refuse("The packer's grid is too fine for this build volume", "Set a larger grid_mm.");
}

Mesh placed_mesh(const PackProblem& problem, const PlacedPart& part) {
  std::vector<const Mesh*> members;
  for (const int item : part.items)
    members.push_back(&problem.items[static_cast<std::size_t>(item)].surface);
  Mesh all;
  for (const Mesh* member : members) {
    std::vector<Mesh::VertexHandle> handles;
    for (const auto vertex : member->vertices())
      handles.push_back(all.add_vertex(part.pose * member->point(vertex)));
    for (const auto face : member->faces()) {
      std::vector<Mesh::VertexHandle> corner;
      for (const auto vertex : member->fv_range(face))
        corner.push_back(handles[static_cast<std::size_t>(vertex.idx())]);
      all.add_face(corner);
    }
  }
  return all;
}

// Rounding of poses may push a part out of the tray by a hair.
void keep_inside(PlacedPart& part, const PackProblem& problem) {
  for (int round = 0; round < 2; ++round) {
    const Box3 box = bounding_box(placed_mesh(problem, part));
    const Vec3 under = (-box.min()).cwiseMax(0.0);
    const Vec3 over = (box.max() - problem.build_mm).cwiseMax(0.0);
    part.pose.translation() += under - over;
  }
}

// The exact figures of every tray, and the cost that follows from them.
void measure(const PackProblem& problem, Packing& packing) {
  int trays = 0;
  for (const PlacedPart& part : packing.parts) trays = std::max(trays, part.tray + 1);
  packing.trays.assign(static_cast<std::size_t>(trays), {});
  packing.cost = 0;
  for (int tray = 0; tray < trays; ++tray) {
    TrayMeasure& figures = packing.trays[static_cast<std::size_t>(tray)];
    std::vector<TriangleSoup> surfaces;
    Box3 box;
    for (const PlacedPart& part : packing.parts) {
      if (part.tray != tray) continue;
      surfaces.push_back(to_soup(placed_mesh(problem, part)));
      for (const Vec3& point : surfaces.back().points) box.extend(point);
      for (const int item : part.items)
        figures.material_mm3 += problem.items[static_cast<std::size_t>(item)].volume_mm3;
      ++figures.parts;
    }
    figures.size_mm = Vec3(box.sizes().x(), box.sizes().y(), box.max().z());
    const ColumnSupport support =
        column_support(surfaces, problem.grid_mm / 2, problem.support_angle, 0);
    figures.support_mm3 = support.below + support.inside;
    packing.cost += problem.cost.evaluate(figures);
  }
}

// Parts come tray by tray, each tray's in the order they were dropped; lifting them in the reverse
// order, nothing lies above the part that is next.
Packing packing_of(const Filling& filling, const Filler& filler, const std::vector<Part>& parts,
                   const PackProblem& problem) {
  Packing packing;
  for (const Placement& placement : filling.placed)
    packing.parts.push_back({parts[static_cast<std::size_t>(placement.part)].items,
                             filler.pose(placement), placement.tray});
  std::stable_sort(packing.parts.begin(), packing.parts.end(),
                   [](const PlacedPart& a, const PlacedPart& b) { return a.tray < b.tray; });
  for (PlacedPart& part : packing.parts) keep_inside(part, problem);
  packing.removal_order.resize(packing.parts.size());
  std::iota(packing.removal_order.rbegin(), packing.removal_order.rend(), 0);
  measure(problem, packing);
  return packing;
}

Packing carried_out(const Plan& plan, const PackProblem& problem, PartMaker& maker, Pace& pace) {
  std::vector<Part> parts = make_parts(plan.parts, maker, problem, pace);
  if (plan.effort != Effort::kSearch)
    parallel_for(parts.size(), [&](std::size_t i) {
      pace.tick();
      parts[i] = maker.with(std::move(parts[i]), plan.effort);
    });
  Filler filler(problem, maker, parts);
  if (plan.effort == Effort::kPlace) filler.set_candidates(kPlaceCandidates);
  if (plan.effort == Effort::kAlone) filler.set_on_plate_only();
  Filling filling;
  for (const int part : plan.order) {
    pace.tick();
    filler.add(filling, part);
  }
  return packing_of(filling, filler, parts, problem);
}

// The search's best few configurations, packed as they were found and with all turns; and every
// part alone on the plate, the best way up, side by side, which the answer must not be worse than.
std::vector<Plan> plans(std::vector<Configuration> configurations) {
  const Configuration unmerged = configurations.front();
  std::stable_sort(configurations.begin(), configurations.end(),
                   [](const Configuration& a, const Configuration& b) { return a.cost < b.cost; });
  configurations.resize(std::min(configurations.size(), kPlacedConfigurations));
  std::vector<Plan> result;
  result.push_back({unmerged.parts, unmerged.order, Effort::kAlone});
  if (configurations[0].parts != unmerged.parts)
    result.push_back({configurations[0].parts, configurations[0].order, Effort::kAlone});
  for (const Configuration& configuration : configurations) {
    result.push_back({configuration.parts, configuration.order, Effort::kSearch});
    result.push_back({configuration.parts, configuration.order, Effort::kPlace});
  }
  return result;
}

double least_gap_mm(const Packing& packing, const PackProblem& problem) {
  double least = problem.gap_mm + 1;
  for (int tray = 0; tray < static_cast<int>(packing.trays.size()); ++tray) {
    std::vector<Mesh> meshes;
    for (const PlacedPart& part : packing.parts)
      if (part.tray == tray) meshes.push_back(placed_mesh(problem, part));
    least = std::min(least, least_gap_mm(meshes, least));
  }
  return least;
}

// The maps bound the meshes, so this finds nothing to do but where the z-buffer's sampling lost
// more than was allowed for; then the plan is carried out again with that much more room.
Packing with_gaps_kept(const Plan& plan, Packing packing, const PackProblem& problem, Pace& pace) {
  double margin = 0;
  for (int repair = 0; repair < kRepairs; ++repair) {
    const double missing = problem.gap_mm - least_gap_mm(packing, problem);
    if (missing <= kGapTolerance_mm) return packing;
    margin += 1.5 * missing + 0.01;
    PartMaker roomier(problem, margin, [&pace] { pace.tick(); });
    packing = carried_out(plan, problem, roomier, pace);
  }
  throw Error(Fault::kInternal,
              fmt::format("The parts could not be kept {} mm apart", problem.gap_mm),
              "Set a smaller grid_mm or a larger gap_mm, and report this model.");
}

}  // namespace

Packing pack(const PackProblem& problem, const Progress& progress) {
  check_settings(problem);
  Pace pace(progress, problem.budget_s);
  PartMaker maker(problem, 0, [&pace] { pace.tick(); });
  const std::vector<Plan> ways = plans(search(problem, maker, pace));
  const Plan* best_plan = nullptr;
  Packing best;
  for (const Plan& plan : ways) {
    if (best_plan != nullptr && plan.effort == Effort::kPlace && pace.time_is_up()) continue;
    Packing packing = carried_out(plan, problem, maker, pace);
    if (best_plan != nullptr && packing.cost >= best.cost) continue;
    best = std::move(packing);
    best_plan = &plan;
  }
  pace.reached(0.97);
  best = with_gaps_kept(*best_plan, std::move(best), problem, pace);
  progress.report("packing", 1);
  return best;
}

}  // namespace packmerger
