// What is sent to a printer: sliced, checked and, for dialect s3g, converted.
#pragma once

#include <optional>
#include <string>

#include "base/progress.h"
#include "model/printer.h"
#include "model/tray.h"
#include "model/warning.h"

namespace packmerger {

struct Program {
  std::string extension;  // "gcode" or "x3g"
  std::string bytes;      // the file
  std::string gcode;      // what it was made of; the same as bytes for dialect gcode
  Warnings warnings;      // skirt_left_out, left_out
};

// Slices the tray with the profile's start and end text, checks every move against the build
// volume (printers/check/check_moves.h), and converts where the dialect is s3g
// (printers/program/x3g.h). build_name is what a Replicator shows while it builds; other characters
// than letters, digits, space, '-', '_' and '.' are replaced, and it is cut to 31. nullopt where no
// program is made (Profile::is_sliced). Throws Error{kBadProfile} when an s3g start text lacks
// homing, position recall or a heat wait (before anything is sliced), when a move leaves the build
// volume or cannot be judged; kUnavailable when PrusaSlicer or gpx is not installed; and what
// slice() throws.
std::optional<Program> make_program(const Profile& profile, const Tray& tray,
                                    const std::string& build_name, const Progress& progress);

}  // namespace packmerger
