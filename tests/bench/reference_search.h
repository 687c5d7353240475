// The search of the paper's sections 6.2 and 6.3 round ReferencePacker: a random order, tabu search
// over swaps, one merge along a random edge, and again until nothing can be merged.
#pragma once

#include <vector>

#include "base/random.h"
#include "bench/reference_packing.h"

namespace packmerger::bench {

// One round of the tabu search.
struct SearchRound {
  double cost = 0;  // of the order it moved to
  double best = 0;  // of all orders so far
};

struct OrderSearch {
  Order order;       // the best
  double cost = 0;   // of it
  int packings = 0;  // that were made for it
  std::vector<SearchRound> rounds;
};

struct ReferenceAnswer {
  std::vector<ItemSet> parts;
  double cost = 0;   // the least of all configurations
  int packings = 0;  // that were made for it
  // how the search for an order went, for each configuration, before the first merge and after each
  std::vector<OrderSearch> searches;
};

// Section 6.2 alone: the best order of these parts, from a random one on. tabu_memory,
// tabu_patience and tabu_samples are the problem's. On one thread. Ends early after limit_s seconds
// where that is above 0, with the best order until then.
OrderSearch search_order(const std::vector<std::vector<ReferenceMaps>>& maps,
                         const std::vector<double>& volumes_mm3, const PackProblem& problem,
                         ReferencePacker& packer, Random& random, double limit_s = 0);

// tabu_memory, tabu_patience, tabu_samples and seed are the problem's. On one thread, every packing
// from its first part on.
ReferenceAnswer reference_search(const PackProblem& problem, ReferencePacker& packer);

}  // namespace packmerger::bench
