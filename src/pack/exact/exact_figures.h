// A packing as its meshes say it is: nothing of the grid.
#pragma once

#include "model/packing.h"

namespace packmerger {

// The part's items as one mesh, model coordinates, mm.
Mesh part_mesh(const PackProblem& problem, const PlacedPart& part);

// The same where it stands on its tray.
Mesh placed_mesh(const PackProblem& problem, const PlacedPart& part);

// Moves a part back into the build volume: rounding of poses may push it out by a hair.
void keep_inside(PlacedPart& part, const PackProblem& problem);

// A tray's figures; placed: the surfaces of its parts where they stand.
TrayMeasure measured(const PackProblem& problem, const std::vector<Mesh>& placed,
                     double material_mm3);

// Enters the figures of every tray, and the cost that follows from them.
void measure(const PackProblem& problem, Packing& packing);

// The least distance between two parts of one tray, mm, told up to a tenth of a millimetre above
// the gap that is asked for.
double least_gap_mm(const Packing& packing, const PackProblem& problem);

}  // namespace packmerger
