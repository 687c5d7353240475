// The placement kernel (paper, section 6.1): where, and turned how, one part adds least to the cost
// of a tray when it is dropped on what is there.
#pragma once

#include <optional>

#include "model/packing.h"
#include "pack/height_field.h"
#include "pack/part.h"

namespace packmerger {

struct PlaceRules {
  Vec3 build_mm = Vec3::Zero();
  double grid_mm = 1;
  const Cost* cost = nullptr;
  int candidates = 12;         // coarse positions that are looked at closely
  bool on_plate_only = false;  // nothing may lie on or over anything
  bool thorough = true;        // looks everywhere before it gives a tray up
};

struct Spot {
  int rotation = 0;  // index into Part::rotations
  int x = 0;         // cells of the fine grid
  int y = 0;
  double z = 0;            // mm
  double cost = 0;         // Cost::evaluate of the tray with the part on it
  double support_mm3 = 0;  // what the part adds
};

// Positions are first rated on the coarse grid, for all rotations; the best of them are then looked
// at closely: all positions of the fine grid round them, with exact heights of the maps. Of equal
// costs the lowest z wins, then the least y, x and rotation, so the answer is always the same one.
// Positions further from the contents than touching cannot be better and are left out.
// Empty where the part has no place on this tray.
std::optional<Spot> best_spot(const TrayState& tray, const Part& part, const PlaceRules& rules);

// Puts the part there.
void put(TrayState& tray, const Part& part, const Spot& spot, double grid_mm);

}  // namespace packmerger
