// What the paper's packer is asked to pack: a model's segments before any merging by the packer.
#pragma once

#include <vector>

#include "bench/reference_packing.h"
#include "model/mesh.h"
#include "model/printer.h"

namespace packmerger::bench {

// The model hollowed, divided and pre-merged with the profile's settings, to be packed by the
// paper's cost (1) on a grid of grid_mm with rotations of step_deg, seed 1.
PackProblem paper_problem(const Mesh& surface, Profile profile, double grid_mm, double step_deg);

// Every item by itself, as ReferencePacker takes it.
struct DrawnParts {
  std::vector<std::vector<ReferenceMaps>> maps;
  std::vector<double> volumes_mm3;
};
DrawnParts draw_items(const PackProblem& problem, ReferencePacker& packer);

}  // namespace packmerger::bench
