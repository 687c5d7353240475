// The last refinement: parts of a finished packing come closer to one another on the meshes
// themselves, which takes back what the finest grid lost. Nested thin shells need it.
#pragma once

#include "model/packing.h"
#include "pack/search/search.h"

namespace packmerger {

// packing: parts that are lifted straight up in removal_order, on trays filled in the order of
// packing.parts, at least problem.gap_mm apart. Each part that does not stand on the plate is
// lowered as far as the gap allows; it is also moved sideways, turned and tilted by less than half
// the gap in all where it sinks deeper for it. The gap is kept, and each part can still be lifted
// straight up without touching another: what it passes on its way is at least the gap aside, so
// two parts that moved by less than half of that each are still apart. Figures and cost of the
// answer are those of the packing given: the caller measures them. The same answer on any number
// of threads; ends early when the pace's time is up.
Packing settled(const PackProblem& problem, Packing packing, Pace& pace);

}  // namespace packmerger
