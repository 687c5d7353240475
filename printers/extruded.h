// How much filament a G-code program pushes out.
#pragma once

#include <string_view>

namespace packmerger {

// mm of filament pushed out while the head moves, for everything but support, and for support
// (";TYPE:Support material", as PrusaSlicer and its relatives write it). Retractions and their
// returns move the filament alone and do not count.
struct Extruded {
  double model_mm = 0;
  double support_mm = 0;
};

// Understands absolute and relative extrusion (M82, M83, G90, G91, G92).
Extruded extruded(std::string_view gcode);

}  // namespace packmerger
