// The search for a cheap layout: tabu search (paper, section 6.2; Glover, 1986) over moves that
// change order, place, rotation and division together.
#pragma once

#include <chrono>
#include <functional>
#include <mutex>
#include <vector>

#include "base/progress.h"
#include "model/packing.h"
#include "pack/search/layout.h"
#include "pack/search/moves.h"

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
  // For what takes long and knows no pace.
  const Progress& progress() const { return silent_; }
  bool has_budget() const { return budget_s_ > 0; }
  // How much of the budget has passed, 0 without one; 1: time is up.
  double passed() const;
  // From now on, passed() is counted in this share of the budget: a stage's own. Not while other
  // threads ask.
  void set_share(double share) { share_ = share; }

 private:
  using Clock = std::chrono::steady_clock;

  Progress progress_;
  Progress silent_;  // heard by nobody, cancelled as the other
  double budget_s_;
  double share_ = 1;
  Clock::time_point start_;
  std::mutex mutex_;
  Clock::time_point reported_;
  double fraction_ = 0;
};

// Told the cost of each layout that is better than all before, on the search's own grid.
using OnBetter = std::function<void(double cost)>;

// Good layouts, cheapest first: the cheapest found for each number of parts, none more than a few
// per cent dearer than the first. Each round draws problem.tabu_samples moves that touch no part
// moved in the last problem.tabu_memory rounds, carries all of them out, in parallel, and goes on
// from the cheapest, better or not. After problem.tabu_patience rounds without a better layout the
// search is kicked away from the best one; after some kicks without a better one it ends or, with a
// budget, begins afresh until that has passed. Without a budget the same seed gives the same answer
// on any number of threads.
std::vector<Layout> search(const PackProblem& problem, const Layouter& layouter, PartMaker& maker,
                           Pace& pace, const OnBetter& on_better = {});

// What such a search begins with: the better of two, of which one takes the largest parts first.
Layout first_layout(const PackProblem& problem, const Layouter& layouter, PartMaker& maker);

}  // namespace packmerger
