// Follows a G-code program and makes sure that every move stays inside the build volume. Slicers
// do not: a part, a skirt or a start text outside the bed is sliced without a word.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "base/geometry.h"
#include "gcode/gcode_line.h"
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

// The plate in the machine's own coordinates.
Plate machine_plate(const Profile& profile);

// Whose reading counts for this profile's programs.
GcodeRules gcode_rules(const Profile& profile);

// Lines are judged by their ends, arcs by their true extent, to 0.01 mm, as gcode/gcode_motion.h
// follows them. After G28 an axis stands at 0 (for gpx nobody knows where); after G161 and G162 it
// is unknown until it is recalled by M132 or set by G92. Moves along an axis that was never homed,
// recalled or set pass as long as nothing is extruded. G92 on a known axis shifts the coordinates
// and moves nothing. A command that cannot be followed is a fault (gcode/known_codes.h): what is
// unknown is not judged.
// Where the plate has walls, moves that extrude stay off them, arcs as well as lines; travel passes
// over them.
std::optional<MoveFault> check_moves(std::string_view gcode, const Box3& volume, GcodeRules rules,
                                     const Plate& plate = {});

}  // namespace packmerger
