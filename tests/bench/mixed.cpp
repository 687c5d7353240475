#include <algorithm>
#include <limits>
#include <memory>

#include "base/random.h"
#include "bench/bench.h"
#include "bench/reference_problem.h"
#include "bench/reference_search.h"
#include "bench/stopwatch.h"
#include "bench/told.h"
#include "fixtures/models.h"
#include "pack/pack.h"
#include "unit/pack/shapes.h"

namespace packmerger::bench {
namespace {

struct Arguments {
  double seconds = 60;
  std::uint64_t seed = 1;
  bool json = false;
};

// A U of two legs on a base, all `thick` mm thick.
Mesh u_shape(double width, double leg, double thick, double depth) {
  return shapes::extruded({{0, 0},
                           {thick, 0},
                           {width - thick, 0},
                           {width, 0},
                           {width, leg},
                           {width - thick, leg},
                           {width - thick, thick},
                           {thick, thick},
                           {thick, leg},
                           {0, leg}},
                          {{0, 1, 7, 8, 9}, {1, 2, 6, 7}, {3, 4, 5, 6, 2}}, depth);
}

// Seven kinds, four of each, every one at a scale of its own between 0.8 and 1.2: cubes of 22 mm;
// tori of ring radius 13 and tube radius 5.5 mm; cups of radius 13, height 28 and wall 3 mm;
// spheres of radius 13 mm; L of legs 32, thickness 12 and depth 16 mm; U of width 32, legs 28,
// thickness 9 and depth 16 mm; corners of a cube with sides of 38 mm.
std::vector<Mesh> mixed_parts(std::uint64_t seed) {
  Random random(seed);
  std::vector<Mesh> parts;
  for (int copy = 0; copy < 4; ++copy)
    for (int kind = 0; kind < 7; ++kind) {
      const double s = 0.8 + 0.4 * random.unit();
      switch (kind) {
        case 0:
          parts.push_back(shapes::box(Vec3::Constant(22 * s)));
          break;
        case 1:
          parts.push_back(closed_mesh(fixtures::torus(13 * s, 5.5 * s, 32, 16)));
          break;
        case 2:
          parts.push_back(shapes::cup(13 * s, 28 * s, 3 * s));
          break;
        case 3:
          parts.push_back(shapes::sphere(13 * s, 24));
          break;
        case 4:
          parts.push_back(shapes::l_shape(32 * s, 12 * s, 16 * s));
          break;
        case 5:
          parts.push_back(u_shape(32 * s, 28 * s, 9 * s, 16 * s));
          break;
        default:
          parts.push_back(shapes::tetrahedron(38 * s));
      }
    }
  return parts;
}

PackProblem mixed_problem(std::uint64_t seed) {
  PackProblem problem;
  for (Mesh& mesh : mixed_parts(seed)) {
    PackItem item;
    item.volume_mm3 = volume_mm3(mesh);
    item.model = static_cast<int>(problem.items.size());
    item.surface = std::move(mesh);
    problem.items.push_back(std::move(item));
  }
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
