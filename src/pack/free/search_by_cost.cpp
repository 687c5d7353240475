#include "pack/free/search_by_cost.h"

#include <algorithm>

#include "pack/exact/exact_disassembly.h"
#include "pack/free/cost_search.h"
#include "pack/free/part_shapes.h"
#include "pack/free/sinking_tray.h"
#include "pack/maps/rotations.h"

namespace packmerger {
namespace {

constexpr int kSinkingPatience = 4;           // failures one after the other
constexpr double kRaise_mm = 0.5;             // what the lattice found is given so much more height
constexpr double kLimit = 1.1;                // of the height, for the lattice
constexpr std::size_t kWays = 6;              // up, of a part on the lattice, in all their turns
constexpr std::size_t kMostDrawn = 4000;      // ways of all parts together
constexpr std::size_t kRoundsOfPatience = 5;  // on the lattice, for each of the height field's

std::vector<Mat3> ways_of(const Part& part, const std::vector<double>& turns, std::size_t parts) {
  const std::size_t most = std::max<std::size_t>(1, kMostDrawn / parts / turns.size());
  std::vector<Mat3> ways;
  for (std::size_t i = 0; i < std::min({kWays, most, part.ways.size()}); ++i)
    for (const double turn : turns)
      ways.push_back(turn_about_z(part.ways[i].turn + turn) * part.ways[i].base);
  return ways;
}

}  // namespace

std::optional<Packing> searched_by_cost(const PackProblem& problem, Packing packing,
                                        PartMaker& maker, Pace& pace) {
  bool found = false;
  Random random(problem.seed);
  std::vector<int> order;
  const std::vector<double> turns = rotation_set(problem.rotation_step).turns;
  const std::size_t patience =
      kRoundsOfPatience * static_cast<std::size_t>(std::max(1, problem.tabu_patience));
  for (int tray = 0; tray < static_cast<int>(packing.trays.size()); ++tray) {
    const TrayParts here = parts_of(packing, tray);
    const std::uint64_t seed = random.bits();
    const double trays_left = static_cast<double>(packing.trays.size()) - tray;
    const double ends = pace.passed() + (1 - pace.passed()) / trays_left;
    const auto is_over = [&] {
      pace.tick();
      return pace.passed() >= ends;
    };
    ExactDisassembly plan{here.order, std::vector<std::vector<Vec3>>(here.parts.size()), {}};
    const auto is_taken_apart = [&](const std::vector<Mesh>& placed) {
      ExactDisassembly next = renewed(plan, StandingParts(placed, pace.progress()),
                                      problem.build_mm.head<2>(), problem.plate, is_over);
      if (!next.stuck.empty()) return false;
      plan = std::move(next);
      return true;
    };
    auto shapes = shapes_of(problem, here.parts, pace);
    std::optional<SinkingTray> sinking;
    if (!shapes.empty()) {
      sinking.emplace(problem, here.parts, std::move(shapes),
                      packing.trays[static_cast<std::size_t>(tray)], seed, is_over, is_taken_apart);
      sinking->sink(kSinkingPatience);
    }
    while (sinking && here.parts.size() > 1 && !is_over()) {
      CostedParts parts{sinking->shapes(), {}};
      for (const PlacedPart& part : here.parts)
        parts.ways.push_back(ways_of(*maker.make(part.items), turns, here.parts.size()));
      CostSearch search(problem, std::move(parts), sinking->poses(),
                        std::min(problem.build_mm.z(), kLimit * sinking->height_mm()),
                        sinking->apart_mm(), random.bits(), is_over);
      search.run(patience);
      if (search.cost() < sinking->cost())
        sinking->sink_from(search.poses(), kRaise_mm, kSinkingPatience);
      if (!pace.has_budget()) break;
    }
    if (!sinking || !sinking->is_cheaper()) {
      for (const int part : here.order)
        order.push_back(static_cast<int>(here.indices[static_cast<std::size_t>(part)]));
      continue;
    }
    found = true;
    for (std::size_t i = 0; i < here.parts.size(); ++i) {
      packing.parts[here.indices[i]].pose = sinking->pose(i);
      packing.removal_paths[here.indices[i]] = plan.paths[i];
    }
    for (const int part : plan.order)
      order.push_back(static_cast<int>(here.indices[static_cast<std::size_t>(part)]));
  }
  if (!found) return std::nullopt;
  packing.removal_order = std::move(order);
  return packing;
}

}  // namespace packmerger
