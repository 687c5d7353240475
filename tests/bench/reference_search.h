// The search of the paper's sections 6.2 and 6.3 round ReferencePacker: a random order, tabu search
// over swaps, one merge along a random edge, and again until nothing can be merged.
#pragma once

#include <vector>

#include "bench/reference_packing.h"

namespace packmerger::bench {

struct ReferenceAnswer {
  std::vector<ItemSet> parts;
  double cost = 0;   // the least of all configurations
  int packings = 0;  // that were made for it
};

// tabu_memory, tabu_patience, tabu_samples and seed are the problem's. On one thread, every packing
// from its first part on.
ReferenceAnswer reference_search(const PackProblem& problem, ReferencePacker& packer);

}  // namespace packmerger::bench
