#include "delivery/ready_program.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <numbers>

#include "delivery/way.h"
#include "firmware_io/gcode/gcode.h"
#include "firmware_io/gcode/gcode_link.h"
#include "firmware_io/gcode/gcode_time_marks.h"
#include "firmware_io/s3g/s3g_actions.h"
#include "firmware_io/s3g/s3g_link.h"
#include "firmware_io/s3g/s3g_time_marks.h"
#include "gcode/program_text.h"
#include "job/compare/comparison_table.h"
#include "model/files/file_format.h"
#include "printers/check/check_moves.h"
#include "printers/price.h"
#include "printers/program/x3g.h"
#include "printers/slice/extruded.h"
#include "printers/slice/slicer_comments.h"

namespace packmerger {
namespace {

constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 30;
constexpr double kUsualFilamentMm = 1.75;

double seconds_of(const std::vector<TimeMark>& marks) {
  return marks.empty() ? 0 : marks.back().expected_s;
}

double filament_section_mm2(const Profile& profile) {
  const auto found = profile.slicer.options.find("filament_diameter");
  const double given =
      found == profile.slicer.options.end() ? 0 : std::strtod(found->second.c_str(), nullptr);
  const double diameter_mm = given > 0 ? given : kUsualFilamentMm;
  return std::numbers::pi * diameter_mm * diameter_mm / 4;
}

void take_time(ReadyProgram& program, const SlicerComments& told, std::string_view gcode) {
  Estimate& estimate = program.estimate;
  const GcodeCommands commands = gcode_commands(gcode);
  // M73 with the minutes that are left is the slicer's own clock too
  const bool has_marks = has_slicer_marks(commands);
  estimate.source = told.time_s || has_marks ? EstimateSource::kProgram : EstimateSource::kMoves;
  estimate.time_s = told.time_s ? *told.time_s : seconds_of(time_marks(commands));
}

void take_material(ReadyProgram& program, const SlicerComments& told, std::string_view gcode) {
  const MaterialSettings& material = program.profile.material;
  const double section_mm2 = filament_section_mm2(program.profile);
  Estimate& estimate = program.estimate;
  if (!told.filament_mm3 && !told.filament_mm && !told.filament_g) {
    const Extruded length = extruded(gcode, gcode_rules(program.profile));
    estimate.model_mm3 = length.model_mm * section_mm2;
    estimate.support_mm3 = length.support_mm * section_mm2;
    estimate.support_g = estimate.support_mm3 / 1000 * material.support_density_g_cm3;
  } else if (told.filament_mm3 || told.filament_mm) {
    estimate.model_mm3 = told.filament_mm3 ? *told.filament_mm3 : *told.filament_mm * section_mm2;
  } else {
    estimate.model_mm3 = *told.filament_g / material.model_density_g_cm3 * 1000;
  }
  estimate.model_g =
      told.filament_g.value_or(estimate.model_mm3 / 1000 * material.model_density_g_cm3);
  program.material_known = true;
}

void judge_moves(ReadyProgram& program, std::string_view gcode) {
  const auto fault = check_moves(gcode, machine_volume(program.profile),
                                 gcode_rules(program.profile), machine_plate(program.profile));
  if (!fault) return;
  program.warnings.push_back(
      {"moves_not_judged", fmt::format("Line {} of the program, \"{}\", {}", fault->line,
                                       fault->command.substr(0, 80), fault->what)});
}

double seconds_of_x3g(std::string_view x3g) { return seconds_of(time_marks(s3g::Actions(x3g))); }

void convert(ReadyProgram& program, const std::string& gcode, const Progress& progress) {
  if (const std::optional<std::string> missing = missing_in_s3g_start(gcode))
    throw Error(Fault::kBadInput, "The program lacks " + *missing + ", and could harm the machine",
                "Let the slicer write the machine's own start text, or give it an .x3g file.");
  X3g x3g = to_x3g(program.profile, gcode, fs::path(program.file).stem().string(), Fault::kBadInput,
                   progress);
  check_x3g(x3g.bytes);
  program.converted = true;
  program.bytes = std::move(x3g.bytes);
  program.warnings.insert(program.warnings.end(), x3g.warnings.begin(), x3g.warnings.end());
  // gpx limits speeds, and hurries where no feed is given
  if (program.estimate.source == EstimateSource::kMoves)
    program.estimate.time_s = seconds_of_x3g(program.bytes);
}

// A way of delivery that takes programs has a language for them (ways_test holds the tables to it).
const ProgramLanguage& language_of(const Profile& profile) {
  if (profile.language() == nullptr)
    throw Error(Fault::kInternal, "The " + profile.name + " is sent no programs",
                "Please report this as a bug.");
  return *profile.language();
}

void take_gcode(ReadyProgram& program, std::string gcode, const Progress& progress) {
  const ProgramLanguage& language = language_of(program.profile);
  const bool converts = language.from_gpx;
  if (!converts) check_gcode(gcode);
  progress.report("checking", 0.3);
  judge_moves(program, gcode);
  progress.report("estimating", 0);
  const SlicerComments told = read_slicer_comments(gcode);
  program.made_by = told.made_by;
  take_time(program, told, gcode);
  take_material(program, told, gcode);
  program.extension = language.extension;
  if (converts)
    convert(program, gcode, progress);
  else
    program.bytes = std::move(gcode);
}

void take_x3g(ReadyProgram& program, std::string x3g) {
  check_x3g(x3g);
  program.estimate.source = EstimateSource::kMoves;
  program.estimate.time_s = seconds_of_x3g(x3g);
  program.extension = language_of(program.profile).extension;
  program.bytes = std::move(x3g);
}

}  // namespace

ReadyProgram read_ready_program(const Profile& profile, const fs::path& file,
                                const Progress& progress) {
  ReadyProgram program;
  program.file = file.filename().string();
  program.profile = profile;
  const FileKind kind = kind_of_file(program.file);
  way_of(profile).check_program(profile, kind);
  progress.report("checking", 0);
  std::string bytes = read_file(file, kMostBytes);
  program.sha256 = sha256_hex(bytes);
  kind == FileKind::kX3g ? take_x3g(program, std::move(bytes))
                         : take_gcode(program, program_text(std::move(bytes)), progress);
  program.estimate.time_s += profile.fdm.start_s;
  price(program.estimate, profile, Assembly{});
  progress.report("checking", 1);
  return program;
}

std::string told_of(const ReadyProgram& program) {
  std::string text = fmt::format("{}: printed as it is{}, about {} ({})", program.file,
                                 program.made_by.empty() ? "" : ", made by " + program.made_by,
                                 spoken_time(program.estimate.time_s),
                                 program.estimate.source == EstimateSource::kProgram
                                     ? "it says so itself"
                                     : "counted from its moves alone");
  if (program.material_known)
    text +=
        fmt::format(", {:.1f} g, {:.2f} {}", program.estimate.model_g + program.estimate.support_g,
                    program.estimate.cost, program.estimate.currency);
  return text + (program.converted ? "; converted to x3g\n" : "\n");
}

}  // namespace packmerger
