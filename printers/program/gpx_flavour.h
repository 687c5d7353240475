// Two flavours of G-code go to gpx, and one command means different things in them: M109 heats the
// nozzle in RepRap's, and the plate in MakerBot's.
#pragma once

#include <string_view>

#include "base/error.h"

namespace packmerger {

enum class GpxFlavour { kRepRap, kMakerBot };

// Told by ";@flavor makerbot", or by commands that only one of them has: M133 to M137 are
// MakerBot's; M82, M83, M190, a fan's speed (M106 S…) and a nozzle's heat in M109 are RepRap's.
// Throws Error{fault} with the line of an M109 that could mean either.
GpxFlavour gpx_flavour(std::string_view gcode, Fault fault);

}  // namespace packmerger
