// A layout taken over to a finer grid, where parts move closer to one another.
#pragma once

#include "pack/layout.h"

namespace packmerger {

// Every part is dropped again on `to`'s grid, in its order and rotation: at the place it had, or at
// the cheapest place within reach_mm of it along x and y, whichever layout is cheaper.
// `from` is the grid of the given layout. What no longer has a place there goes to the cheapest one
// on its tray, or, where it stays near, to the cheapest of the smallest surroundings that have one,
// which on a fine grid is found far sooner.
Layout refined(const Layout& layout, const Grid& from, const Layouter& to, PartMaker& maker,
               double reach_mm, bool stays_near);

}  // namespace packmerger
