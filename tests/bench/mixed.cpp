#include <algorithm>
#include <limits>
#include <memory>

#include "bench/bench.h"
#include "bench/mixed_parts.h"
#include "bench/reference_problem.h"
#include "bench/reference_search.h"
#include "bench/stopwatch.h"
#include "bench/told.h"
#include "pack/pack.h"

namespace packmerger::bench {
namespace {

struct Arguments {
  double seconds = 60;
  std::uint64_t seed = 1;
  bool json = false;
};

PackProblem mixed_problem(std::uint64_t seed) {
  PackProblem problem;
  problem.items = mixed_items(28, seed);
  problem.build_mm = Vec3(100, 100, 150);
  problem.gap_mm = 0;
  problem.anywhere = true;
  problem.grid_mm = 1;
  problem.search_grid_mm = 2;
  problem.rotation_step = radians(90);
  problem.cost.evaluate = [](const TrayMeasure& tray) { return tray.size_mm.z(); };
  problem.cost.lower_bound = problem.cost.evaluate;
  problem.seed = seed;
  return problem;
}

// The paper's search, begun again from other orders until the time is up.
OrderSearch reference_for(const PackProblem& problem, double limit_s) {
  const Stopwatch watch;
  ReferencePacker packer(problem);
  const DrawnParts parts = draw_items(problem, packer);
  Random random(problem.seed);
  OrderSearch best;
  best.cost = std::numeric_limits<double>::infinity();
  do {
    const OrderSearch one = search_order(parts.maps, parts.volumes_mm3, problem, packer, random,
                                         std::max(0.1, limit_s - watch.seconds()));
    best.cost = std::min(best.cost, one.cost);
    best.packings += one.packings;
  } while (watch.seconds() < limit_s);
  return best;
}

void run(const Arguments& arguments) {
  PackProblem problem = mixed_problem(arguments.seed);
  double volume = 0;
  for (const PackItem& item : problem.items) volume += item.volume_mm3;
  const OrderSearch reference = reference_for(problem, arguments.seconds);

  problem.budget_s = arguments.seconds;
  const Stopwatch watch;
  const Packing packing = pack(problem, {});
  const double taken_s = watch.seconds();
  int paths = 0;
  for (const auto& path : packing.removal_paths) paths += path.empty() ? 0 : 1;

  nlohmann::ordered_json told;
  told["parts"] = problem.items.size();
  told["volume_mm3"] = volume;
  told["reference_mm"] = reference.cost;
  told["reference_packings"] = reference.packings;
  told["height_mm"] = packing.cost;
  told["trays"] = packing.trays.size();
  told["ratio"] = packing.cost / reference.cost;
  told["density"] = volume / (1e4 * packing.cost);
  told["removal_paths"] = paths;
  told["seconds"] = taken_s;
  print_told(told, arguments.json);
}

}  // namespace

void add_mixed(CLI::App& program) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* verb =
      program.add_subcommand("mixed", "28 small parts on 100 x 100 mm, against the paper's packer");
  verb->add_option("--seconds", arguments->seconds, "for each of the two")->capture_default_str();
  verb->add_option("--seed", arguments->seed, "of the parts and of the searches")
      ->capture_default_str();
  verb->add_flag("--json", arguments->json);
  verb->callback([arguments] { run(*arguments); });
}

}  // namespace packmerger::bench
