// The search of the paper's section 6: orders by tabu search, then a merge along a random edge, and
// again, until nothing can be merged.
#pragma once

#include <chrono>
#include <mutex>
#include <vector>

#include "base/progress.h"
#include "model/packing.h"
#include "pack/merge.h"
#include "pack/order.h"
#include "pack/part.h"

namespace packmerger {

// Tells the listener how far the packing is, seldom enough to cost nothing, and keeps the clock.
// Thread-safe.
class Pace {
 public:
  // budget_s: 0: none.
  Pace(const Progress& progress, double budget_s);

  // fraction: 0..1; what was reported never falls.
  void reached(double fraction);
  // To be called often: reports from time to time, and throws when cancellation was asked for.
  void tick();
  bool time_is_up() const;

 private:
  using Clock = std::chrono::steady_clock;

  const Progress& progress_;
  Clock::time_point end_;
  std::mutex mutex_;
  Clock::time_point reported_;
  double fraction_ = 0;
};

// A division into parts and the best order found for it.
struct Configuration {
  std::vector<ItemSet> parts;
  Order order;      // of indices into parts
  double cost = 0;  // as the search measures it
};

// Parts for item sets, made in parallel. Throws Error{kBadInput} naming a part that fits the build
// volume in no rotation.
std::vector<Part> make_parts(const std::vector<ItemSet>& sets, PartMaker& maker,
                             const PackProblem& problem, Pace& pace);

// All configurations the search went through, the unmerged one first. Deterministic unless the
// budget ends it.
std::vector<Configuration> search(const PackProblem& problem, PartMaker& maker, Pace& pace);

}  // namespace packmerger
