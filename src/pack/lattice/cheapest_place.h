// About the cheapest place of a part among the others: at every position of the tray the lowest
// height where it is free, rated by what it adds to the tray's cost (Highway, chosen at run time).
#pragma once

#include <limits>
#include <vector>

#include "pack/lattice/lowest_place.h"
#include "pack/lattice/support_columns.h"

namespace packmerger {

// What a place costs beside the support that it adds.
struct PlaceCosts {
  std::vector<double> by_column;  // by x of the place, y, and height
  std::vector<double> by_row;
  std::vector<double> by_height;  // as many as the part may stand at
  double per_mm3 = 0;             // of support
};

struct CostedPlace {
  BitPlace place;
  double cost = std::numeric_limits<double>::infinity();
};

// Puts into `best` the cheapest place where there is one that is cheaper than that in it, the first
// by y and x of equal ones. The support is estimated: blocks of cells count as their means, and the
// tray as what is seen of it from above. pool() was called since the tray changed. unit_mm: of the
// lattice.
bool cheaper_place(const HeightBits& tray, const SupportColumns& columns, const SupportedPart& part,
                   const PlaceCosts& costs, double unit_mm, CostedPlace& best);

}  // namespace packmerger
