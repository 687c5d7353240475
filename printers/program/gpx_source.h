// G-code written anew so that gpx takes it whole. gpx passes over what it does not know, clamps
// heats and sets axes it was not asked to, with a warning at most; what it is given here it does.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "base/error.h"
#include "model/warning.h"

namespace packmerger {

// °C; gpx makes less of what is more.
inline constexpr double kHottestPlate = 130;
inline constexpr double kHottestNozzle = 280;

struct GpxSource {
  std::string gcode;  // every line numbered (N) as the line it was made of
  bool makerbot_flavour = false;
  // left_out: messages, questions and accelerations, which harm nothing; fan_full: a fan that was
  // to turn at some speed
  Warnings warnings;
};

// Axes absolute, in mm and the machine's own coordinates; filament absolute by tool (A, B); arcs as
// lines that leave them by less than 0.01 mm; G4 in ms. G92 is passed on only where it tells the
// machine where it is, and then for every axis: gpx would set those that are not named to 0.
// Throws Error{fault}, naming the line, for what cannot be converted whole.
GpxSource gpx_source(std::string_view gcode, Fault fault);

// "flavor makerbot" of ";@flavor makerbot", which gpx obeys; nothing for other comments.
std::optional<std::string_view> gpx_macro(std::string_view line);

// A line as messages show it: no longer than 80 bytes.
std::string shown_line(std::string_view line);

}  // namespace packmerger
