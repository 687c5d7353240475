#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "base/parallel.h"
#include "bench/bench.h"
#include "bench/stopwatch.h"
#include "bench/told.h"
#include "job/divide.h"
#include "model/printer.h"
#include "pack/maps/columns.h"
#include "pack/maps/ways_up.h"
#include "shape/cut/cut_plans.h"
#include "shape/divide/adjacency.h"
#include "shape/divide/part_surface.h"
#include "shape/divide/premerge.h"
#include "shape/divide/segment.h"
#include "shape/divide/smooth_cuts.h"
#include "shape/solid/solidify.h"

namespace packmerger::bench {
namespace {

struct Arguments {
  std::string model;
  std::string profile = "objet30";
  double size_mm = 100;
  bool y_up = false;
  bool hollow = true;
  int parts = 0;
  int effort = CutSearch().effort;
  int samples = CutSearch().samples;
  std::uint64_t seed = 1;
};

constexpr double kPartPrice = 0.02;  // of V_o
constexpr int kDirections = 200;
constexpr std::size_t kKept = 6;
constexpr double kCoarse_mm = 1.5;
constexpr double kFine_mm = 0.4;

double support_cm3(const Mesh& surface, const Vec3& up, double support_angle, double step_mm) {
  Pose pose = Pose::Identity();
  pose.linear() = turn_between(up, Vec3::UnitZ());
  const Mesh standing = transformed(surface, pose);
  const double lowest = bounding_box(standing).min().z();
  const ColumnSupport support = column_support({standing}, step_mm, support_angle, lowest);
  return (support.below + support.inside) / 1000;
}

// A regular set over the sphere, and the flat faces of the part.
std::vector<Vec3> directions_of(const Mesh& surface) {
  std::vector<Vec3> directions = spread_directions(kDirections);
  for (const Vec3& area : flat_facets({surface})) {
    directions.push_back(area.normalized());
    directions.push_back(-area.normalized());
  }
  return directions;
}

// The least support of a part standing alone, over many directions, on the exact triangles.
double least_support_cm3(const Mesh& surface, double support_angle) {
  const std::vector<Vec3> directions = directions_of(surface);
  std::vector<std::pair<double, std::size_t>> ranked(directions.size());
  parallel_for(directions.size(), [&](std::size_t i) {
    ranked[i] = {support_cm3(surface, directions[i], support_angle, kCoarse_mm), i};
  });
  std::sort(ranked.begin(), ranked.end());
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < std::min(kKept, ranked.size()); ++i)
    least = std::min(least,
                     support_cm3(surface, directions[ranked[i].second], support_angle, kFine_mm));
  return least;
}

void print_row(const std::string& name, int planned, double judged_cm3, const TetMesh& tets,
               const Segments& segments, const Warnings& warnings, double solid_cm3,
               double support_angle, double seconds) {
  double exact = 0;
  for (const SegmentSurface& part : part_surfaces(tets, segments))
    exact += least_support_cm3(part.surface, support_angle);
  double least_glue = std::numeric_limits<double>::infinity();
  for (const SegmentEdge& edge : adjacency(tets, segments))
    least_glue = std::min(least_glue, edge.area_mm2);
  const std::vector<double> volumes = segment_volumes(tets, segments);
  fmt::print(
      "{:<10} {:>7} {:>6} {:>8.1f} {:>6.2f} {:>8.1f} {:>6.2f} {:>8.1f} {:>7.1f} {:>6.1f}{}\n", name,
      planned, segments.count, judged_cm3, judged_cm3 / solid_cm3, exact, exact / solid_cm3,
      least_glue, 100 * *std::min_element(volumes.begin(), volumes.end()) / total_volume_mm3(tets),
      seconds, warnings.empty() ? "" : "  !");
}

void run(const Arguments& arguments) {
  Profile profile = read_profile(arguments.profile);
  if (arguments.parts > 0) profile.shape.parts = arguments.parts;
  const Progress silent;
  Warnings warnings;
  const LoadedModel loaded = load_model(arguments.model, arguments.size_mm);
  const Mesh& model = *loaded.surface;
  const TetMesh tets = solidify(model, profile.shape, arguments.hollow, warnings, silent).tets;
  const BuildVolume build = build_volume(profile);
  const double angle = radians(profile.support_angle_deg);
  const double solid =
      support_cm3(model, arguments.y_up ? Vec3::UnitY() : Vec3::UnitZ(), angle, kFine_mm);
  fmt::print("{} at {:g} mm: {} tetrahedra, {:.1f} cm³; solid as it stands needs {:.1f} cm³\n",
             loaded.input.file, arguments.size_mm, tets.count(), total_volume_mm3(tets) / 1000,
             solid);
  fmt::print("{:<10} {:>7} {:>6} {:>8} {:>6} {:>8} {:>6} {:>8} {:>7} {:>6}\n", "", "planned",
             "parts", "judged", "ratio", "exact", "ratio", "least mm²", "least %", "s");

  {
    const Stopwatch watch;
    TetMesh mesh = tets;
    warnings.clear();
    Segments segments = premerge(mesh, segment(mesh, profile.shape, arguments.seed, silent),
                                 profile.shape, build, warnings, silent);
    smooth_cuts(mesh, segments, profile.shape, silent);
    print_row("paper", segments.count, 0, mesh, segments, warnings, solid, angle, watch.seconds());
  }
  const Stopwatch watch;
  CutSearch search;
  search.support_angle = angle;
  search.part_price_mm3 = kPartPrice * total_volume_mm3(tets);
  search.effort = arguments.effort;
  search.samples = arguments.samples;
  const auto plans = cut_plans(tets, profile.shape, build, search, arguments.seed, silent);
  fmt::print("{} plans in {:.2f} s\n", plans.size(), watch.seconds());
  std::fflush(stdout);
  for (const CutPlan& plan : plans) {
    const Stopwatch of_cut;
    TetMesh mesh = tets;
    warnings.clear();
    Segments segments = cut_as_planned(mesh, plan, silent);
    const int cut = segments.count;
    segments = premerge(mesh, segments, profile.shape, build, warnings, silent);
    const double seconds = of_cut.seconds();
    print_row(plan.construction, cut, plan.support_mm3 / 1000, mesh, segments, warnings, solid,
              angle, seconds);
  }
}

}  // namespace

void add_partitions(CLI::App& program) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* verb = program.add_subcommand(
      "partitions", "divisions of a model, and the support their parts need standing alone");
  verb->add_option("MODEL", arguments->model)->required();
  verb->add_option("--profile", arguments->profile)->capture_default_str();
  verb->add_option("--size", arguments->size_mm, "longest side, mm")->capture_default_str();
  verb->add_flag("--y-up", arguments->y_up, "the solid stands with the file's y axis up");
  verb->add_flag("!--no-hollow", arguments->hollow, "divide the solid");
  verb->add_option("--parts", arguments->parts, "most parts; 0: the profile's");
  verb->add_option("--effort", arguments->effort, "changes tried")->capture_default_str();
  verb->add_option("--samples", arguments->samples, "points that stand for the matter")
      ->capture_default_str();
  verb->add_option("--seed", arguments->seed)->capture_default_str();
  verb->callback([arguments] { run(*arguments); });
}

}  // namespace packmerger::bench
