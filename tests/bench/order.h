// Tabu search over orders (paper, section 6.2). It knows nothing of packing: an order is a
// permutation of 0..n-1 and has a cost.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

namespace packmerger {

using Order = std::vector<int>;

struct TabuSettings {
  int memory = 3;     // rounds a swap stays forbidden after it was made
  int patience = 10;  // rounds without a better order before the search ends
  int samples = 8;    // swaps tried in one round
  std::uint64_t seed = 1;
};

struct OrderCost {
  // The cost of an order that differs from the one last given to `moved` (or the start) from
  // position first_change on. May stop early and return infinity once the cost is sure to exceed
  // give_up_above. Called from several threads at once.
  std::function<double(const Order& order, std::size_t first_change, double give_up_above)>
      evaluate;
  // The search now stands at this order. Called from the searching thread alone.
  std::function<void(const Order& order, std::size_t first_change)> moved;
  // Called once a round from the searching thread, with the number of rounds without a better
  // order; false ends the search.
  std::function<bool(int rounds_without_better)> go_on;
};

struct FoundOrder {
  Order order;
  double cost = 0;
};

// Each round tries `samples` random swaps that are not forbidden, makes the cheapest of them (of
// equal ones the first drawn) whether or not it improves, and remembers the best order of all. The
// same seed gives the same answer on any number of threads.
FoundOrder tabu_search(const Order& start, double start_cost, const TabuSettings& settings,
                       const OrderCost& cost);

}  // namespace packmerger
