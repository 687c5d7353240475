// A packing as its meshes say it is. Nothing of the search is asked: gaps by FCL over all pairs,
// ways out facet by facet (src/pack/exact), everything else counted here.
#pragma once

#include <string>
#include <vector>

#include "model/packing.h"

namespace packmerger::bench {

struct TrayCheck {
  double volume_mm3 = 0;  // of all parts
  double height_mm = 0;   // of all trays, one upon the other
  double density = 0;     // volume ÷ (base × height)
  double apart_mm = 0;    // of the two parts that are closest; told up to 0.1 mm above the gap
  double outside_mm = 0;  // of the box; at most 0 where all are within
  int straight_up = 0;    // parts that are lifted at once, in the order given
  int by_path = 0;        // that are moved along their path before
  // What of the packer's promises does not hold, as sentences; empty: all of it holds.
  std::vector<std::string> broken;
};

TrayCheck check_packing(const PackProblem& problem, const Packing& packing);

// The parts of each tray where they stand, mm.
std::vector<std::vector<Mesh>> standing_parts(const PackProblem& problem, const Packing& packing);

}  // namespace packmerger::bench
