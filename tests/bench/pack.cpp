// The packer against the reference, in one run, on the same parts.
#include <memory>
#include <string>

#include "bench/bench.h"
#include "bench/models.h"
#include "bench/packing_table/solids.h"
#include "bench/reference_problem.h"
#include "bench/speed_ratios.h"
#include "bench/stopwatch.h"
#include "bench/told.h"
#include "model/printer.h"
#include "pack/pack.h"

namespace packmerger::bench {
namespace {

using Json = nlohmann::ordered_json;

struct Arguments {
  std::string model;  // empty: the bunny of the npm package
  std::string profile = "objet30";
  double size_mm = kBunnyLongest_mm;
  bool json = false;
};

Mesh surface_of(const Arguments& arguments) {
  if (arguments.model.empty()) return scaled(bunny_model(), arguments.size_mm / kBunnyLongest_mm);
  return *load_model(arguments.model, arguments.size_mm).surface;
}

// The whole packer with the profile's own grid and rotations; the cost is that of exact meshes.
void measure_whole(const PackProblem& problem, Json& told) {
  const Stopwatch watch;
  const Packing packing = pack(problem, {});
  told["pack"] = {
      {"seconds", watch.seconds()}, {"cost", packing.cost}, {"parts", packing.parts.size()}};
}

void run(const Arguments& arguments) {
  Profile profile = read_profile(arguments.profile);
  profile.shape.segmentation = Segmentation::kPaper;
  const PackProblem problem = paper_problem(surface_of(arguments), profile, profile.pack.grid_mm,
                                            profile.pack.rotation_step_deg);
  Json told;
  measure_kernel(told);
  measure_one_packing(problem, told);
  measure_search(problem, told);
  measure_whole(problem, told);
  print_told(told, arguments.json);
}

}  // namespace

void add_pack(CLI::App& program) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* verb = program.add_subcommand("pack", "the packer against the paper's, in one run");
  verb->add_option("MODEL", arguments->model, "the npm bunny where none is given");
  verb->add_option("--profile", arguments->profile)->capture_default_str();
  verb->add_option("--size", arguments->size_mm, "longest side, mm")->capture_default_str();
  verb->add_flag("--json", arguments->json);
  verb->callback([arguments] { run(*arguments); });
}

}  // namespace packmerger::bench
