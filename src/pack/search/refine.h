// A layout taken over to a finer grid, where parts move closer to one another.
#pragma once

#include <vector>

#include "pack/search/layout.h"

namespace packmerger {

// Every part is dropped again on `to`'s grid, in its order and rotation: at the cheapest place
// within a reach, along x and y, of where it was. There is a layout for each reach; the best is
// returned. `from` is the grid of the given layout. What no longer has a place there goes to the
// cheapest one on its tray, or, where it stays near, to the cheapest of the smallest surroundings
// that have one, which on a fine grid is found far sooner.
Layout refined(const Layout& layout, const Grid& from, const Layouter& to, PartMaker& maker,
               const std::vector<double>& reaches_mm, bool stays_near);

}  // namespace packmerger
