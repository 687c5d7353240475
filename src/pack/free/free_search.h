// Layouts of parts that may stand anywhere on their tray, in cavities and under overhangs too: the
// lattice finds them (limit_search.h), separation makes them exact, compression lowers them, and
// only what can be taken apart counts.
#pragma once

#include <optional>

#include "base/effort.h"
#include "model/packing.h"
#include "pack/search/search.h"

namespace packmerger {

// packing: parts that keep their gap, and the order and paths that take them out. Every tray is
// searched for a lower layout of its parts; nothing where none was found. The answer keeps what
// pack.h promises but for rounding at the walls, and for its figures and cost, which are those of
// the packing given: the caller measures them. With a budget it goes on until the pace's time is
// up. Without one it ends after a number of rounds without a better layout, or when it did so much
// work as suits the number of parts; problem.tabu_patience sets both, and the same seed gives the
// same answer on any number of threads. effort: to which the work is added.
std::optional<Packing> searched_freely(const PackProblem& problem, Packing packing, Pace& pace,
                                       Effort& effort);

}  // namespace packmerger
