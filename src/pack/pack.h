// Packing and merging (paper, section 6): poses for all items on as few trays as needed, some of
// them merged, at little cost.
#pragma once

#include <memory>

#include "base/progress.h"
#include "model/packing.h"

namespace packmerger {

// Guaranteed of the answer, on the exact meshes:
//  - every item is in exactly one part, and items of one part keep their places to one another;
//  - every part lies within [0, build_mm] and over no wall of the plate (to 1e-6 mm), and one of
//    each tray at least stands on z = 0;
//  - two parts of one tray are gap_mm apart at least, in every direction (to 1e-6 mm);
//  - taken in removal_order, each part can be moved along its removal path, if it has one, and then
//    be lifted straight up without touching another;
//  - trays[i].support_mm3 is counted on the exact meshes, and cost is the sum of Cost::evaluate;
//  - cost does not exceed that of all parts side by side, each the best way up.
// The same problem and seed give the same answer on any number of threads, unless budget_s ends the
// search.
//
// Throws Error{kBadInput} where an item fits the build volume in no rotation, with its size;
// Error{kUsage} for settings without sense; Error{kInterrupted} when cancelled.
Packing pack(const PackProblem& problem, const Progress& progress);

// A short packing, enough to tell which of several divisions of a model packs better in a fraction
// of the time. Costs are those of layouts by the samples that a search sees. Throws as pack().
class TrialPacking {
 public:
  // Both must outlive it.
  TrialPacking(const PackProblem& problem, const Progress& progress);
  ~TrialPacking();
  TrialPacking(const TrialPacking&) = delete;
  TrialPacking& operator=(const TrialPacking&) = delete;

  // Of the layout with which a search begins.
  double greedy_cost();
  // Of the best one that a short search finds. What was drawn for the other is used again.
  double searched_cost();

 private:
  struct Bench;
  std::unique_ptr<Bench> bench_;
};

}  // namespace packmerger
