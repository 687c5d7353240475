#include "bench/order.h"

#include <algorithm>
#include <atomic>
#include <deque>
#include <limits>
#include <utility>

#include "base/parallel.h"
#include "base/random.h"

namespace packmerger {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Swap {
  std::size_t first = 0;  // positions, first < second
  std::size_t second = 0;
};

// The two elements that a swap exchanges; forbidding a move forbids undoing it.
using Move = std::pair<int, int>;

Move move_of(const Order& order, const Swap& swap) {
  return std::minmax(order[swap.first], order[swap.second]);
}

Order swapped(Order order, const Swap& swap) {
  std::swap(order[swap.first], order[swap.second]);
  return order;
}

// Different permitted swaps in random order; all of them where there are no more than asked for.
std::vector<Swap> sampled_swaps(const Order& order, const std::deque<Move>& forbidden, int samples,
                                Random& random) {
  std::vector<Swap> all;
  for (std::size_t i = 0; i < order.size(); ++i)
    for (std::size_t j = i + 1; j < order.size(); ++j) {
      const Swap swap{i, j};
      if (std::find(forbidden.begin(), forbidden.end(), move_of(order, swap)) == forbidden.end())
        all.push_back(swap);
    }
  const std::size_t count = std::min(all.size(), static_cast<std::size_t>(std::max(1, samples)));
  for (std::size_t i = 0; i < count; ++i) std::swap(all[i], all[i + random.below(all.size() - i)]);
  all.resize(count);
  return all;
}

void lower(std::atomic<double>& least, double value) {
  double known = least.load();
  while (value < known && !least.compare_exchange_weak(known, value)) {
  }
}

// Costs of the swapped orders. One that exceeds another of the round may come out as infinity,
// which never is the least: the choice does not depend on the threads.
std::vector<double> costs_of(const Order& order, const std::vector<Swap>& swaps,
                             const OrderCost& cost) {
  std::vector<double> costs(swaps.size(), kInfinity);
  std::atomic<double> least = kInfinity;
  parallel_for(swaps.size(), [&](std::size_t i) {
    costs[i] = cost.evaluate(swapped(order, swaps[i]), swaps[i].first, least.load());
    lower(least, costs[i]);
  });
  return costs;
}

}  // namespace

FoundOrder tabu_search(const Order& start, double start_cost, const TabuSettings& settings,
                       const OrderCost& cost) {
  Random random(settings.seed);
  FoundOrder best{start, start_cost};
  Order order = start;
  std::deque<Move> forbidden;
  int rounds_without_better = 0;
  while (rounds_without_better < settings.patience && cost.go_on(rounds_without_better)) {
    const std::vector<Swap> swaps = sampled_swaps(order, forbidden, settings.samples, random);
    if (swaps.empty()) break;
    const std::vector<double> costs = costs_of(order, swaps, cost);
    const std::size_t chosen =
        static_cast<std::size_t>(std::min_element(costs.begin(), costs.end()) - costs.begin());
    forbidden.push_back(move_of(order, swaps[chosen]));
    if (static_cast<int>(forbidden.size()) > settings.memory) forbidden.pop_front();
    order = swapped(std::move(order), swaps[chosen]);
    cost.moved(order, swaps[chosen].first);
    ++rounds_without_better;
    if (costs[chosen] < best.cost) {
      best = {order, costs[chosen]};
      rounds_without_better = 0;
    }
  }
  return best;
}

}  // namespace packmerger
