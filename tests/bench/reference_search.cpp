#include "bench/reference_search.h"

#include <limits>
#include <numeric>

#include "base/error.h"
#include "base/parallel.h"
#include "base/random.h"

namespace packmerger::bench {
namespace {

double volume_of(const ItemSet& items, const PackProblem& problem) {
  double volume = 0;
  for (const int item : items) volume += problem.items[static_cast<std::size_t>(item)].volume_mm3;
  return volume;
}

// The best order of these parts, from a random one on.
double best_order_cost(const std::vector<std::vector<ReferenceMaps>>& maps,
                       const std::vector<double>& volumes, const PackProblem& problem,
                       ReferencePacker& packer, Random& random, int& packings) {
  Order start(maps.size());
  std::iota(start.begin(), start.end(), 0);
  random.shuffle(start);
  const auto cost_of = [&](const Order& order) {
    ++packings;
    return packer.pack(maps, volumes, order).cost;
  };
  OrderCost cost;
  cost.evaluate = [&](const Order& order, std::size_t, double) { return cost_of(order); };
  cost.moved = [](const Order&, std::size_t) {};
  cost.go_on = [](int) { return true; };
  const TabuSettings settings{problem.tabu_memory, problem.tabu_patience, problem.tabu_samples,
                              random.bits()};
  return tabu_search(start, cost_of(start), settings, cost).cost;
}

}  // namespace

ReferenceAnswer reference_search(const PackProblem& problem, ReferencePacker& packer) {
  const ThreadLimit one_thread(1);
  Random random(problem.seed);
  std::vector<ItemSet> parts;
  std::vector<std::vector<ReferenceMaps>> maps;
  std::vector<double> volumes;
  for (int item = 0; item < static_cast<int>(problem.items.size()); ++item) {
    parts.push_back({item});
    maps.push_back(packer.draw(parts.back()));
    volumes.push_back(volume_of(parts.back(), problem));
  }
  ReferenceAnswer best;
  best.cost = std::numeric_limits<double>::infinity();
  while (true) {
    const double cost = best_order_cost(maps, volumes, problem, packer, random, best.packings);
    if (cost < best.cost) {
      best.parts = parts;
      best.cost = cost;
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
