#include "bench/reference_search.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "base/error.h"
#include "base/parallel.h"
#include "bench/reference_problem.h"
#include "bench/stopwatch.h"

namespace packmerger::bench {
OrderSearch search_order(const std::vector<std::vector<ReferenceMaps>>& maps,
                         const std::vector<double>& volumes_mm3, const PackProblem& problem,
                         ReferencePacker& packer, Random& random, double limit_s) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const ThreadLimit one_thread(1);
  const Stopwatch watch;
  const auto over = [&] { return limit_s > 0 && watch.seconds() >= limit_s; };
  Order start(maps.size());
  std::iota(start.begin(), start.end(), 0);
  random.shuffle(start);
  OrderSearch search;
  double least_of_round = kInfinity;
  const auto cost_of = [&](const Order& order) {
    ++search.packings;
    return packer.pack(maps, volumes_mm3, order).cost;
  };
  search.cost = cost_of(start);
  OrderCost cost;
  cost.evaluate = [&](const Order& order, std::size_t, double) {
    const double found = over() ? kInfinity : cost_of(order);
    least_of_round = std::min(least_of_round, found);
    return found;
  };
  cost.moved = [&](const Order&, std::size_t) {
    search.cost = std::min(search.cost, least_of_round);
    search.rounds.push_back({least_of_round, search.cost});
    least_of_round = kInfinity;
  };
  cost.go_on = [&](int) { return !over(); };
  const TabuSettings settings{problem.tabu_memory, problem.tabu_patience, problem.tabu_samples,
                              random.bits()};
  const FoundOrder found = tabu_search(start, search.cost, settings, cost);
  search.order = found.order;
  search.cost = found.cost;
  return search;
}

ReferenceAnswer reference_search(const PackProblem& problem, ReferencePacker& packer) {
  Random random(problem.seed);
  std::vector<ItemSet> parts;
  auto [maps, volumes] = draw_items(problem, packer);
  for (int item = 0; item < static_cast<int>(problem.items.size()); ++item) parts.push_back({item});
  ReferenceAnswer best;
  best.cost = std::numeric_limits<double>::infinity();
  while (true) {
    best.searches.push_back(search_order(maps, volumes, problem, packer, random));
    const OrderSearch& search = best.searches.back();
    best.packings += search.packings;
    if (search.cost < best.cost) {
      best.parts = parts;
      best.cost = search.cost;
    }
    std::vector<std::pair<int, int>> pairs = mergeable_pairs(parts, problem);
    random.shuffle(pairs);
    bool merged_one = false;
    for (const auto& [a, b] : pairs) {
      const auto into = static_cast<std::size_t>(a);
      const auto from = static_cast<std::size_t>(b);
      const ItemSet both = merged(parts[into], parts[from]);
      std::vector<ReferenceMaps> drawn = packer.draw(both);
      if (drawn.empty()) continue;
      parts[into] = both;
      maps[into] = std::move(drawn);
      volumes[into] += volumes[from];
      parts.erase(parts.begin() + b);
      maps.erase(maps.begin() + b);
      volumes.erase(volumes.begin() + b);
      merged_one = true;
      break;
    }
    if (!merged_one) break;
  }
  if (best.parts.empty())
    throw Error(Fault::kBadInput, "The reference packer found no place for a part on one tray",
                "Choose a smaller model or a larger printer.");
  return best;
}

}  // namespace packmerger::bench
