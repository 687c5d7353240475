#include <fmt/format.h>

#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <numeric>
#include <string>
#include <vector>

#include "bench/bench.h"
#include "bench/reference_problem.h"
#include "bench/reference_search.h"
#include "bench/stopwatch.h"
#include "bench/told.h"
#include "model/printer.h"

namespace packmerger::bench {
namespace {

struct Arguments {
  std::string model;
  std::string profile = "objet30";
  double size_mm = 141.6;
  double grid_mm = 2;
  double step_deg = 60;
  bool search = false;
  bool json = false;
};

PackProblem problem_of(const Arguments& arguments) {
  return paper_problem(*load_model(arguments.model, arguments.size_mm).surface,
                       read_profile(arguments.profile), arguments.grid_mm, arguments.step_deg);
}

void run(const Arguments& arguments) {
  const PackProblem problem = problem_of(arguments);
  ReferencePacker packer(problem);
  nlohmann::ordered_json told;
  told["parts"] = problem.items.size();
  if (arguments.search) {
    const Stopwatch watch;
    const ReferenceAnswer answer = reference_search(problem, packer);
    told["parts_left"] = answer.parts.size();
    told["packings"] = answer.packings;
    told["cost"] = answer.cost;
    told["seconds"] = watch.seconds();
    if (arguments.json)
      for (const OrderSearch& search : answer.searches) {
        std::vector<double> costs;
        for (const SearchRound& round : search.rounds) costs.push_back(round.best);
        told["convergence"].push_back(costs);
      }
  } else {
    const Stopwatch drawing;
    const DrawnParts drawn = draw_items(problem, packer);
    told["drawing_s"] = drawing.seconds();
    Order order(drawn.maps.size());
    std::iota(order.begin(), order.end(), 0);
    const Stopwatch watch;
    told["cost"] = packer.pack(drawn.maps, drawn.volumes_mm3, order).cost;
    told["seconds"] = watch.seconds();
    told["gcells_per_s"] = packer.cells() / watch.seconds() / 1e9;
  }
  print_told(told, arguments.json);
}

}  // namespace

void add_reference(CLI::App& program) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* verb = program.add_subcommand("reference", "the paper's packer on a model's segments");
  verb->add_option("MODEL", arguments->model)->required();
  verb->add_option("--profile", arguments->profile)->capture_default_str();
  verb->add_option("--size", arguments->size_mm, "longest side, mm")->capture_default_str();
  verb->add_option("--grid", arguments->grid_mm, "cell of the height field, mm")
      ->capture_default_str();
  verb->add_option("--step", arguments->step_deg, "rotation step, degrees")->capture_default_str();
  verb->add_flag("--search", arguments->search, "orders and merges too, not one packing alone");
  verb->add_flag("--json", arguments->json);
  verb->callback([arguments] { run(*arguments); });
}

}  // namespace packmerger::bench
