#include "printers/program/program.h"

#include <fmt/format.h>

#include "printers/check/check_moves.h"
#include "printers/program/x3g.h"
#include "printers/slice/slice.h"

namespace packmerger {
namespace {

void check_s3g_start(const Profile& profile) {
  const std::optional<std::string> missing = missing_in_s3g_start(profile.slicer.start_gcode);
  if (!missing) return;
  throw Error(Fault::kBadProfile,
              fmt::format("Profile {}: slicer.start_gcode lacks {}", profile.id, *missing),
              "Add it to the profile's start text; nothing is made that could harm the machine.");
}

void check_volume(const Profile& profile, std::string_view gcode) {
  const std::optional<MoveFault> fault =
      check_moves(gcode, machine_volume(profile), gcode_rules(profile), machine_plate(profile));
  if (!fault) return;
  throw Error(
      Fault::kBadProfile,
      fmt::format("Line {} of the program, \"{}\", {}", fault->line, fault->command, fault->what),
      "Leave more room at the sides of the tray, or correct slicer.options, start_gcode "
      "and end_gcode in the profile.");
}

}  // namespace

std::optional<Program> make_program(const Profile& profile, const Tray& tray,
                                    const std::string& build_name, const Progress& progress) {
  const ProgramLanguage* language = profile.language();
  if (language == nullptr) return std::nullopt;
  if (language->from_gpx) check_s3g_start(profile);
  SlicedTray sliced = slice(profile, tray, SliceFlavour::kProgram, progress);
  check_volume(profile, sliced.gcode);

  Program program;
  if (sliced.skirt_left_out)
    program.warnings.push_back(
        {"skirt_left_out",
         "The skirt that primes the nozzle is left out: the tray has no room for it."});
  program.extension = language->extension;
  if (language->from_gpx) {
    X3g x3g = to_x3g(profile, sliced.gcode, build_name, Fault::kBadProfile, progress);
    program.bytes = std::move(x3g.bytes);
    program.warnings.insert(program.warnings.end(), x3g.warnings.begin(), x3g.warnings.end());
  } else {
    program.bytes = sliced.gcode;
  }
  program.gcode = std::move(sliced.gcode);
  return program;
}

}  // namespace packmerger
