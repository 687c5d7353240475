#include <cmath>
#include <memory>

#include "bench/bench.h"
#include "bench/stopwatch.h"
#include "bench/told.h"
#include "pack/exact/exact_figures.h"
#include "pack/pack.h"
#include "unit/pack/shapes.h"

namespace packmerger::bench {
namespace {

constexpr double kRadius_mm = 50;
constexpr double kWall_mm = 3;
constexpr int kPatches = 6;
constexpr int kFacets = 24;  // along a patch's edge

struct Arguments {
  double gap_mm = 0;
  double grid_mm = 1;
  std::uint64_t seed = 1;
  bool json = false;
};

// The height of the patches lying in one another as bowls do. Two spheres' sides, raised by d
// against one another, meet first at a corner c of the inner side: |c + d·up| = R, where c lies
// r / √3 along up.
double nested_height_mm() {
  const double inner = kRadius_mm - kWall_mm;
  const double corner = inner / std::sqrt(3.0);
  const double spacing =
      std::sqrt(corner * corner + kRadius_mm * kRadius_mm - inner * inner) - corner;
  return kRadius_mm - corner + (kPatches - 1) * spacing;
}

PackProblem nested_problem(const Arguments& arguments) {
  PackProblem problem;
  for (int face = 0; face < kPatches; ++face) {
    PackItem item;
    item.surface = shapes::sphere_patch(kRadius_mm, kWall_mm, face, kFacets);
    item.volume_mm3 = volume_mm3(item.surface);
    item.model = face;
    problem.items.push_back(std::move(item));
  }
  problem.build_mm = Vec3(72, 72, 200);
  problem.gap_mm = arguments.gap_mm;
  problem.grid_mm = arguments.grid_mm;
  problem.rotation_step = radians(90);
  problem.cost.evaluate = [](const TrayMeasure& tray) { return tray.size_mm.z(); };
  problem.cost.lower_bound = problem.cost.evaluate;
  problem.seed = arguments.seed;
  return problem;
}

void run(const Arguments& arguments) {
  const PackProblem problem = nested_problem(arguments);
  const Stopwatch watch;
  const Packing packing = pack(problem, {});
  nlohmann::ordered_json told;
  told["height_mm"] = packing.cost;
  told["nested_bowls_mm"] = nested_height_mm();
  told["ratio"] = packing.cost / nested_height_mm();
  told["least_gap_mm"] = least_gap_mm(packing, problem);
  told["trays"] = packing.trays.size();
  told["seconds"] = watch.seconds();
  print_told(told, arguments.json);
}

}  // namespace

void add_nested(CLI::App& program) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* verb = program.add_subcommand(
      "nested", "six patches of a 3 mm shell of 50 mm radius on 72 x 72 mm, as low as they go");
  verb->add_option("--gap", arguments->gap_mm, "mm")->capture_default_str();
  verb->add_option("--grid", arguments->grid_mm, "grid_mm")->capture_default_str();
  verb->add_option("--seed", arguments->seed, "of the search")->capture_default_str();
  verb->add_flag("--json", arguments->json);
  verb->callback([arguments] { run(*arguments); });
}

}  // namespace packmerger::bench
