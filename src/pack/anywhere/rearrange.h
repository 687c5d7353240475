// The last improvement of a finished tray: parts are taken out and put back wherever they are
// cheapest, in cavities and under overhangs too, which dropping from above never finds: ruin and
// recreate (Schrimpf et al., 2000).
#pragma once

#include <optional>

#include "model/packing.h"
#include "pack/maps/part_maker.h"
#include "pack/search/search.h"

namespace packmerger {

// packing: parts at least problem.gap_mm apart, `finest_mm` the grid on which it was finished.
// maker tells the ways up of the parts. Goes on for problem.tabu_patience rounds without a cheaper
// tray or until the pace's time is up; without a budget the same seed gives the
// same answer on any number of threads. Figures and cost of the answer are those of the packing
// given: the caller measures them. A try takes long where parts are
// large, and the clock is looked at between tries. Every tray of the answer can be taken apart as
// told; the gap is kept as far as columns of bounds on the finest grid say, which is to within
// rounding. Nothing where no order was found in which some tray can be taken apart.
std::optional<Packing> rearranged(const PackProblem& problem, Packing packing, double finest_mm,
                                  PartMaker& maker, Pace& pace);

}  // namespace packmerger
