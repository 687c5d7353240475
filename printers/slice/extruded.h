// How much filament a G-code program pushes out.
#pragma once

#include <string_view>

#include "gcode/gcode_line.h"

namespace packmerger {

// mm of filament pushed out while the head moves, for everything but support, and for support
// (";TYPE:Support material", as PrusaSlicer and its relatives write it). Retractions and their
// returns move the filament alone and do not count.
struct Extruded {
  double model_mm = 0;
  double support_mm = 0;
};

// As gcode/gcode_motion.h reads it: arcs, inches, filament counted in mm³ and M221 included. A
// whole circle that names neither X nor Y moves the head too.
Extruded extruded(std::string_view gcode, GcodeRules rules);

}  // namespace packmerger
