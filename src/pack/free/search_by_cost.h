// Trays made cheaper while their parts may stand, turn and sink anywhere: for objectives that weigh
// support and the base beside the height.
#pragma once

#include <optional>

#include "model/packing.h"
#include "pack/maps/part_maker.h"
#include "pack/search/search.h"

namespace packmerger {

// packing: finished, on as many trays; every tray is taken as it is, or cheaper. maker tells the
// ways up of the parts. Parts are gap_mm apart (and kLeastApart_mm) on the exact meshes, every one
// has a way out in the order told, straight up or along its path; the figures are those of the
// packing given: the caller measures them. Ends when nothing cheaper was found for a while
// (tabu_patience), or when the pace's time is up; without a budget the same seed gives the same
// answer on any number of threads. Nothing where no tray became cheaper.
std::optional<Packing> searched_by_cost(const PackProblem& problem, Packing packing,
                                        PartMaker& maker, Pace& pace);

}  // namespace packmerger
