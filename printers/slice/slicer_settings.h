// PrusaSlicer's settings file, made from a profile and the room around a tray's contents.
#pragma once

#include <map>
#include <string>
#include <string_view>

#include "model/printer.h"
#include "printers/slice/slice.h"

namespace packmerger {

struct SlicerConfig {
  std::map<std::string, std::string> values;  // as the file holds them
  bool skirt_left_out = false;
};

// room_mm: from the contents to the nearest side of the build volume, seen from above.
// An empty post_process, which most exported settings have, is dropped. Throws Error{kBadProfile}
// where slicer.options names programs to run there, names what follows from the profile's other
// keys, or a name that cannot be one.
SlicerConfig slicer_config(const Profile& profile, SliceFlavour flavour, double room_mm);

// The file's text.
std::string ini_text(const SlicerConfig& config);

// The settings the slicer says it used, from the end of its G-code.
std::map<std::string, std::string> settings_used(std::string_view gcode);

// PrusaSlicer passes over options it does not know and replaces values it cannot read, mostly
// without a word. Throws Error{kBadProfile} for an option that is not among those used, or was used
// with another value.
void check_settings_used(const Profile& profile, const std::map<std::string, std::string>& used);

}  // namespace packmerger
