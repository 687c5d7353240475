#include <fmt/format.h>

#include <chrono>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <numeric>
#include <string>

#include "bench/bench.h"
#include "bench/reference_search.h"
#include "job/divide.h"
#include "job/load_models.h"
#include "job/pack_models.h"
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

class Stopwatch {
 public:
  double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

PackProblem problem_of(const Arguments& arguments) {
  Profile profile = read_profile(arguments.profile);
  profile.pack.objective = Objective::kPaper;
  profile.pack.grid_mm = arguments.grid_mm;
  profile.pack.rotation_step_deg = arguments.step_deg;
  const Progress silent;
  Warnings warnings;
  Sizing sizing;
  sizing.size_mm = arguments.size_mm;
  const auto loaded = load_models({arguments.model}, sizing, warnings, silent);
  const auto divided = std::make_shared<const Divided>(
      divide(*loaded.front().surface, profile, true, 1, warnings, silent));
  return packing_problem({divided}, profile, 1, 0);
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
  } else {
    std::vector<std::vector<ReferenceMaps>> maps;
    std::vector<double> volumes;
    const Stopwatch drawing;
    for (int item = 0; item < static_cast<int>(problem.items.size()); ++item) {
      maps.push_back(packer.draw({item}));
      volumes.push_back(problem.items[static_cast<std::size_t>(item)].volume_mm3);
    }
    told["drawing_s"] = drawing.seconds();
    Order order(maps.size());
    std::iota(order.begin(), order.end(), 0);
    const Stopwatch watch;
    told["cost"] = packer.pack(maps, volumes, order).cost;
    told["seconds"] = watch.seconds();
    told["gcells_per_s"] = packer.cells() / watch.seconds() / 1e9;
  }
  if (arguments.json)
    std::cout << told.dump(2) << '\n';
  else
    for (const auto& [key, value] : told.items()) fmt::print("{:<14} {}\n", key, value.dump());
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
