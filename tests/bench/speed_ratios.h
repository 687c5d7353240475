// How many times faster the packer is than the paper's on the same parts. Each enters what it
// measured under keys of its own.
#pragma once

#include <nlohmann/json.hpp>

#include "model/packing.h"

namespace packmerger::bench {

// One packing, with the same maps, order and rotations; what is timed is the placing alone.
void measure_one_packing(PackProblem problem, nlohmann::ordered_json& told);

// The search until it reaches the cost at which the paper's ends, with and without room for the
// gap.
void measure_search(PackProblem problem, nlohmann::ordered_json& told);

// The kernel against the least that it has to do.
void measure_kernel(nlohmann::ordered_json& told);

}  // namespace packmerger::bench
