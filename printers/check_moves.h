// Follows a G-code program and makes sure that every move stays inside the build volume. Slicers
// do not: a part, a skirt or a start text outside the bed is sliced without a word.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "base/geometry.h"
#include "model/printer.h"

namespace packmerger {

// The first thing that is wrong with a program.
struct MoveFault {
  int line = 0;         // from 1
  std::string command;  // the line as it stands, without line end
  std::string what;     // "goes to X 113.20, 0.70 mm beyond the build volume (-112.50 to 112.50)"
};

// The volume that may be printed in, in the machine's own coordinates.
Box3 machine_volume(const Profile& profile);

// Understands G0 G1 G2 G3 (I J and R), G20 G21, G90 G91, G92, M82 M83, homing (G28, G161, G162) and
// position recall (M132); line numbers, checksums, both kinds of comments. Lines are judged by
// their ends, arcs by their true extent, to 0.01 mm. An axis is unknown before it was homed or set;
// after G28 it stands at 0, after G161, G162 and M132 it is unknown until it is told by G92 or an
// absolute move. Moves along an unknown axis pass, extruding ones do not. G92 on a known axis
// shifts the coordinates and moves nothing. Codes that move in ways not listed are faults.
std::optional<MoveFault> check_moves(std::string_view gcode, const Box3& volume);

}  // namespace packmerger
