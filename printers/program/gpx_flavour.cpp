#include "printers/program/gpx_flavour.h"

#include <optional>
#include <string>

#include <fmt/format.h>

#include "gcode/gcode_line.h"
#include "printers/program/gpx_source.h"

namespace packmerger {
namespace {

struct Signs {
  std::optional<GpxFlavour> told;
  bool makerbot = false;
  bool reprap = false;
  int plate_line = 0;  // the first M109 whose heat a plate can have
  std::string plate_text;
};

void read_command(const GcodeLine& line, Signs& signs) {
  if (line.letter() != 'M') return;
  const int number = line.number();
  if (number >= 133 && number <= 137) signs.makerbot = true;
  if (number == 82 || number == 83 || number == 190) signs.reprap = true;
  if (number == 106 && line.has('S')) signs.reprap = true;
  if (number == 109 && line.value_or('S', 0) > kHottestPlate) signs.reprap = true;
}

Signs read_signs(std::string_view gcode) {
  Signs signs;
  for_each_line(gcode, [&](std::string_view text, int number) {
    if (const auto macro = gpx_macro(text); macro && macro->starts_with("flavor"))
      signs.told = macro->find("makerbot") != std::string_view::npos ? GpxFlavour::kMakerBot
                                                                     : GpxFlavour::kRepRap;
    const GcodeLine line(text, GcodeRules::kGpx);
    read_command(line, signs);
    const double heat = line.value_or('S', 0);
    if (line.is('M', 109) && heat > 0 && heat <= kHottestPlate && signs.plate_line == 0) {
      signs.plate_line = number;
      signs.plate_text = text;
    }
    return true;
  });
  return signs;
}

}  // namespace

GpxFlavour gpx_flavour(std::string_view gcode, Fault fault) {
  const Signs signs = read_signs(gcode);
  if (signs.told) return *signs.told;
  if (!signs.makerbot) return GpxFlavour::kRepRap;
  if (!signs.reprap) return GpxFlavour::kMakerBot;
  if (signs.plate_line == 0) return GpxFlavour::kRepRap;
  throw Error(
      fault,
      fmt::format("Line {} of the program, \"{}\", could mean the plate (MakerBot's G-code) or the "
                  "nozzle (RepRap's): the program has commands of both",
                  signs.plate_line, shown_line(signs.plate_text)),
      "Write M140 for the plate, or M104 and M133 for the nozzle, or say which it is in a line "
      "\";@flavor makerbot\" or \";@flavor reprap\".");
}

}  // namespace packmerger
