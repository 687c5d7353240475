// Figures 7 and 8, about the paper's own packer: the reference.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "base/random.h"
#include "bench/figure.h"
#include "bench/models.h"
#include "bench/reference_problem.h"
#include "bench/reference_search.h"
#include "bench/stopwatch.h"

namespace packmerger::bench {
namespace {

constexpr double kGrid_mm = 4;

// The sphere's parts before any merging by the packer, on a corner of the tray just large enough
// for a search: the reference tries every cell of it.
PackProblem few_parts() {
  Profile profile = read_profile("objet30");
  profile.build_mm = {120, 100, profile.build_mm[2]};
  profile.shape.voxel_mm = 2;  // fewer triangles to draw
  return paper_problem(sphere_model(), profile, kGrid_mm, 90);
}

}  // namespace

void figure_7(const FigureRun& run) {
  constexpr int kOrders = 5;
  PackProblem problem = few_parts();
  nlohmann::ordered_json data;
  data["parts"] = problem.items.size();
  data["orders"] = kOrders;
  PlotSeries mean{"mean of 5 orders", {}}, best{"best of 5 orders", {}};
  PlotSeries seconds{"drawing and packing", {}};
  for (const double step : {90.0, 60.0, 45.0, 30.0}) {
    fmt::print(stderr, "the paper's packer with rotations of {:g}°\n", step);
    problem.rotation_step = radians(step);
    ReferencePacker packer(problem);
    const Stopwatch drawing;
    const DrawnParts drawn = draw_items(problem, packer);
    const double drawing_s = drawing.seconds();
    Random random(run.seed);
    Order order(drawn.maps.size());
    std::iota(order.begin(), order.end(), 0);
    std::vector<double> costs;
    const Stopwatch packing;
    for (int i = 0; i < kOrders; ++i) {
      random.shuffle(order);
      costs.push_back(packer.pack(drawn.maps, drawn.volumes_mm3, order).cost);
    }
    const double packing_s = packing.seconds() / kOrders;
    const double mean_cost = std::accumulate(costs.begin(), costs.end(), 0.0) / kOrders;
    const double best_cost = *std::min_element(costs.begin(), costs.end());
    data["steps"].push_back({{"step_deg", step},
                             {"mean_cost", mean_cost},
                             {"best_cost", best_cost},
                             {"costs", costs},
                             {"drawing_s", drawing_s},
                             {"packing_s", packing_s}});
    mean.points.push_back({step, mean_cost / 1000, ""});
    best.points.push_back({step, best_cost / 1000, ""});
    seconds.points.push_back({step, drawing_s + packing_s, ""});
  }
  write_data(run, "fig7", data);
  write_plot(run, "fig7_cost",
             {"The paper's packer: cost of a packing", "rotation step, °", "f, cm³", {mean, best}});
  write_plot(run, "fig7_time",
             {"The paper's packer: time of a packing", "rotation step, °", "s", {seconds}});
}

void figure_8(const FigureRun& run) {
  PackProblem problem = few_parts();
  ReferencePacker packer(problem);
  const DrawnParts drawn = draw_items(problem, packer);
  const auto parts = static_cast<int>(problem.items.size());
  const int swaps = parts * (parts - 1) / 2;
  nlohmann::ordered_json data;
  data["parts"] = parts;
  data["swaps"] = swaps;
  Plot plot{"The paper's tabu search", "iteration", "best f so far, cm³", {}};
  for (const double share : {0.05, 0.1, 0.25, 0.5, 1.0}) {
    const std::string name = fmt::format("{:g} % of the swaps", 100 * share);
    fmt::print(stderr, "the paper's tabu search with {}\n", name);
    problem.tabu_samples = std::max(1, static_cast<int>(std::lround(share * swaps)));
    Random random(run.seed);  // all searches start at the same order
    const Stopwatch watch;
    const OrderSearch search = search_order(drawn.maps, drawn.volumes_mm3, problem, packer, random);
    nlohmann::ordered_json told{{"share", share},
                                {"samples", problem.tabu_samples},
                                {"cost", search.cost},
                                {"packings", search.packings},
                                {"seconds", watch.seconds()}};
    PlotSeries series{name, {}};
    for (std::size_t i = 0; i < search.rounds.size(); ++i) {
      const auto& [cost, best] = search.rounds[i];
      told["cost_by_round"].push_back(cost);
      told["best_by_round"].push_back(best);
      series.points.push_back({static_cast<double>(i + 1), best / 1000, ""});
    }
    data["searches"].push_back(told);
    plot.series.push_back(series);
  }
  write_data(run, "fig8", data);
  write_plot(run, "fig8", plot);
}

}  // namespace packmerger::bench
