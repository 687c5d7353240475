#include <sys/resource.h>

#include <memory>

#include "bench/bench.h"
#include "bench/mixed_parts.h"
#include "bench/stopwatch.h"
#include "bench/told.h"
#include "job/pack_models.h"
#include "model/printer.h"
#include "pack/pack.h"

namespace packmerger::bench {
namespace {

struct Arguments {
  int parts = 100;
  std::string profile = "objet30";
  std::uint64_t seed = 1;
  bool json = false;
};

double peak_memory_mb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

void run(const Arguments& arguments) {
  PackProblem problem = packing_problem({}, read_profile(arguments.profile), arguments.seed, 0);
  problem.items = mixed_items(arguments.parts, arguments.seed);
  const Stopwatch watch;
  const Packing packing = pack(problem, {});
  const double taken_s = watch.seconds();
  double matter = 0;
  double room = 0;
  for (const TrayMeasure& tray : packing.trays) {
    matter += tray.material_mm3;
    room += problem.build_mm.x() * problem.build_mm.y() * tray.size_mm.z();
  }
  nlohmann::ordered_json told;
  told["parts"] = arguments.parts;
  told["seconds"] = taken_s;
  told["peak_memory_mb"] = peak_memory_mb();
  told["trays"] = packing.trays.size();
  std::vector<double> heights;
  for (const TrayMeasure& tray : packing.trays) heights.push_back(tray.size_mm.z());
  told["heights_mm"] = heights;
  told["cost"] = packing.cost;
  told["density"] = matter / room;
  print_told(told, arguments.json);
}

}  // namespace

void add_many(CLI::App& program) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* verb = program.add_subcommand("many", "many small parts, all different, on few trays");
  verb->add_option("--parts", arguments->parts)->capture_default_str();
  verb->add_option("--profile", arguments->profile)->capture_default_str();
  verb->add_option("--seed", arguments->seed)->capture_default_str();
  verb->add_flag("--json", arguments->json);
  verb->callback([arguments] { run(*arguments); });
}

}  // namespace packmerger::bench
