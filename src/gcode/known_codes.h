// What commands do that are neither moves nor modes: whether a program that holds them can still
// be followed. After Marlin's list of commands (2.1), and gpx's (2.6.8).
#pragma once

#include <optional>
#include <string>

#include "gcode/gcode_line.h"

namespace packmerger {

// Why nobody can tell where the head is after this command, or what later ones mean: it moves by
// itself, changes a scale, the origin or a limit, starts other commands, or is not known. Nothing
// for commands that leave the head, its coordinates and its limits as they are.
std::optional<std::string> cannot_follow(const GcodeLine& line, GcodeRules rules);

}  // namespace packmerger
