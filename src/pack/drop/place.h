// The placement of one part (paper, section 6.1): where, and turned how, it adds least to the cost
// of a tray when it is dropped on what is there.
#pragma once

#include <optional>
#include <span>

#include "pack/drop/tray_state.h"

namespace packmerger {

struct PlaceRules {
  bool on_plate_only = false;  // every part stands on the plate
  Range x = kAllCells;         // looked at
  Range y = kAllCells;
};

struct Spot {
  int rotation = 0;  // index into the rotations given
  int x = 0;         // cells
  int y = 0;
  Height z = 0;            // units
  double cost = 0;         // Cost::evaluate of the tray with the part on it
  double support_mm3 = 0;  // what the part adds
  Height top = 0;          // units, of the part there
};

// The cheapest of all positions in all rotations. Of equal costs the lowest top of the part wins,
// then the lowest z, then the least y, x and rotation, so the answer is always the same one. What
// is skipped is skipped for a proven reason only: a bound of its cost exceeds the best so far.
// Empty where the part has no place on this tray.
std::optional<Spot> best_spot(const TrayState& tray, std::span<const RotatedPart* const> rotations,
                              double volume_mm3, const TraySpec& spec,
                              const PlaceRules& rules = {});

}  // namespace packmerger
