// G-code turned into x3g, a Replicator's own language, by gpx: whole or not at all.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "base/error.h"
#include "base/progress.h"
#include "model/printer.h"
#include "model/warning.h"

namespace packmerger {

// A Replicator that was not homed, does not know where home is or extrudes cold breaks something.
// What the text lacks, with the codes that would do; nothing where it is complete.
std::optional<std::string> missing_in_s3g_start(std::string_view gcode);

struct X3g {
  std::string bytes;
  Warnings warnings;  // left_out
};

// build_name is what a Replicator shows while it builds; other characters than letters, digits,
// space, '-', '_' and '.' are replaced, and it is cut to 31. Throws Error{fault}, naming the line,
// where gpx would leave out or change something (printers/program/gpx_source.h) or warns of
// anything; kBadProfile where gpx cannot convert it for the profile's machine, kUnavailable where
// it is not installed, kInterrupted.
X3g to_x3g(const Profile& profile, const std::string& gcode, const std::string& build_name,
           Fault fault, const Progress& progress);

}  // namespace packmerger
