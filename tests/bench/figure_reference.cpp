// Figures 7 and 8, about the paper's own packer: the reference.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "base/error.h"
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

// The mean over the searches of the best cost so far; one that has ended keeps its last.
PlotSeries mean_convergence(const std::string& name, const std::vector<OrderSearch>& searches) {
  std::size_t rounds = 0;
  for (const OrderSearch& search : searches) rounds = std::max(rounds, search.rounds.size());
  PlotSeries series{name, {}};
  for (std::size_t round = 0; round < rounds; ++round) {
    double sum = 0;
    for (const OrderSearch& search : searches)
      sum += round < search.rounds.size() ? search.rounds[round].best : search.cost;
    series.points.push_back(
        {static_cast<double>(round + 1), sum / static_cast<double>(searches.size()) / 1000, ""});
  }
  return series;
}

}  // namespace

void figure_7(const FigureRun& run) {
  constexpr int kOrders = 20;
  PackProblem problem = few_parts();
  nlohmann::ordered_json data;
  data["parts"] = problem.items.size();
  data["orders"] = kOrders;
  PlotSeries mean{fmt::format("mean of {} orders", kOrders), {}},
      best{fmt::format("best of {} orders", kOrders), {}};
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
      if (!std::isfinite(costs.back()))
        throw Error(Fault::kInternal, "The paper's packer found no place for a part of figure 7",
                    "Give few_parts() a larger tray.");
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
  constexpr int kStarts = 4;
  PackProblem problem = few_parts();
  ReferencePacker packer(problem);
  const DrawnParts drawn = draw_items(problem, packer);
  const auto parts = static_cast<int>(problem.items.size());
  const int swaps = parts * (parts - 1) / 2;
  nlohmann::ordered_json data;
  data["parts"] = parts;
  data["swaps"] = swaps;
  Plot plot{fmt::format("The paper's tabu search, mean of {} starts", kStarts),
            "iteration",
            "best f so far, cm³",
            {}};
  for (const double share : {0.05, 0.1, 0.25, 0.5, 1.0}) {
    const std::string name = fmt::format("{:g} % of the swaps", 100 * share);
    fmt::print(stderr, "the paper's tabu search with {}\n", name);
    problem.tabu_samples = std::max(1, static_cast<int>(std::lround(share * swaps)));
    Random random(run.seed);  // the same starts for every share
    nlohmann::ordered_json told{{"share", share}, {"samples", problem.tabu_samples}};
    std::vector<OrderSearch> searches;
    const Stopwatch watch;
    for (int start = 0; start < kStarts; ++start)
      searches.push_back(search_order(drawn.maps, drawn.volumes_mm3, problem, packer, random));
    told["seconds"] = watch.seconds() / kStarts;
    for (const OrderSearch& search : searches) {
      std::vector<double> best;
      for (const SearchRound& round : search.rounds) best.push_back(round.best);
      told["costs"].push_back(search.cost);
      told["packings"].push_back(search.packings);
      told["best_by_round"].push_back(best);
    }
    plot.series.push_back(mean_convergence(name, searches));
    data["searches"].push_back(told);
  }
  write_data(run, "fig8", data);
  write_plot(run, "fig8", plot);
}

}  // namespace packmerger::bench
