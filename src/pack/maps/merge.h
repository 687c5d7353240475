// Additional merging (paper, section 6.3): parts as sets of items, joined along the edges of the
// adjacency graph.
#pragma once

#include <utility>
#include <vector>

#include "base/random.h"
#include "model/packing.h"

namespace packmerger {

using ItemSet = std::vector<int>;  // sorted

// Pairs of parts (a < b) that share an edge of the graph, come from the same model and together
// shut no cavity; sorted.
std::vector<std::pair<int, int>> mergeable_pairs(const std::vector<ItemSet>& parts,
                                                 const PackProblem& problem);

ItemSet merged(const ItemSet& a, const ItemSet& b);

// Two parts that together are the given one of several items, each connected by the graph where the
// given one is: two random items are the seeds that the halves grow from.
std::pair<ItemSet, ItemSet> divided(const ItemSet& items, const PackProblem& problem,
                                    Random& random);

}  // namespace packmerger
