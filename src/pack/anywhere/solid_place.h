// The cheapest places for a part on a tray, anywhere it is free: not only where it comes to lie
// when it is dropped from above.
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "model/packing.h"
#include "pack/anywhere/solid_tray.h"
#include "pack/drop/place.h"

namespace packmerger {

struct SolidSpot {
  int rotation = 0;  // index into the rotations given
  int x = 0;         // cells
  int y = 0;
  int z = 0;         // units
  int top = 0;       // units
  double cost = 0;   // Cost::evaluate of the tray with the part on it
  bool open = true;  // nothing above is in its way
};

struct SolidRules {
  Range x = kAllCells;  // looked at
  Range y = kAllCells;
  double give_up_above = std::numeric_limits<double>::infinity();  // cost
  std::size_t most = 1;  // places below something that are told, beside the best open one
};

// Of every position at most one place for each stretch of heights at which the part is free: its
// lowest (of stretches shorter than 1/256 of the tray, some are not seen). Cheapest first; of equal
// costs the lowest top wins, then the least rotation, y and x. The best place with nothing above
// is the last: what lies below something costs less, or it is not told. Of two places below
// something in one rotation that lie closer than a few cells only the better is told.
// `before` is the tray's measure without the part.
std::vector<SolidSpot> solid_spots(const SolidTray& tray, const TrayMeasure& before,
                                   std::span<const SolidPart* const> rotations, double volume_mm3,
                                   const Cost& cost, const SolidRules& rules);

}  // namespace packmerger
