// Divisions to start a search from. Internal to this folder.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/progress.h"
#include "shape/cut/cut_state.h"

namespace packmerger {

struct Start {
  std::string construction;
  CutState state;
};

// "cuts": the piece that needs most support is cut by the best of many random recipes, and so on
// until there are rules.most_parts; "overcut": half as many pieces more, merged back; one for each
// number of parts from there down to half. "slabs" across and "rings" about the model's principal
// axes. Same samples and seed: same answer on any number of threads.
std::vector<Start> cut_starts(const MatterSamples& samples, const CutRules& rules,
                              const FitTest& fit, std::uint64_t seed, const Progress& progress);

}  // namespace packmerger
