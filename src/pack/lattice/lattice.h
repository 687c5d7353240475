// The lattice that parts are placed on, by what they measure.
#pragma once

#include <vector>

#include "model/plate.h"
#include "pack/lattice/height_bits.h"

namespace packmerger {

// Cells as coarse as the parts allow, and heights up to limit_mm. shapes: by part; limit_mm with
// the room apart_mm that parts keep from one another, which the lattice has on every side.
BitGrid lattice_for(const std::vector<const Shape*>& shapes, const Vec2& base_mm, double apart_mm,
                    double limit_mm);

// An empty tray. Walls reach half of apart_mm less far than they stand: parts are grown by so much,
// but may touch them.
HeightBits tray_with_walls(const BitGrid& grid, const Plate& plate, double apart_mm);

}  // namespace packmerger
