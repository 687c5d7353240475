// The paper's packer (reference_packing.h) as a yardstick where the least height is sought: its
// search begun again from other orders until the time is up, on one thread.
#pragma once

#include <cstdint>

#include "bench/reference_packing.h"
#include "model/packing.h"

namespace packmerger::bench {

// By the paper's own samples at the cells' centres: parts may cut into one another by up to a cell.
struct SampledAnswer {
  double cost = 0;
  int packings = 0;  // that were made for it
};
SampledAnswer paper_sampled(const PackProblem& problem, double limit_s, std::uint64_t seed,
                            Ties ties = Ties::kLowestPlace);

// The same on equal terms: with so much more room for its samples that the parts are as far apart
// on the exact meshes as the problem asks. A layout that is not is packed again in its order with
// more room, which later searches keep.
struct ApartAnswer {
  Packing packing;
  int packings = 0;
  double room_mm = 0;  // added to the gap at last
};
ApartAnswer paper_apart(const PackProblem& problem, double limit_s, std::uint64_t seed);

// A packing by the reference as the packer gives its own; costs and figures are not entered.
Packing as_packing(const ReferencePacking& reference,
                   const std::vector<std::vector<ReferenceMaps>>& maps, const PackProblem& problem,
                   double unit_mm);

}  // namespace packmerger::bench
