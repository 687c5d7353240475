#include "printers/program.h"

#include <algorithm>
#include <array>
#include <cctype>

#include <fmt/format.h>

#include "base/files.h"
#include "base/process.h"
#include "gcode/gcode_line.h"
#include "printers/check_moves.h"
#include "printers/slice.h"

namespace packmerger {
namespace {

constexpr double kTimeoutS = 600;
constexpr std::uint64_t kMaxProgramBytes = std::uint64_t{4} << 30;
constexpr std::size_t kMaxNameLength = 31;
constexpr char kEndOfBuild = '\x9A';

bool has_one_of(std::string_view gcode, std::initializer_list<std::pair<char, int>> commands) {
  bool found = false;
  for_each_line(gcode, [&](std::string_view text, int) {
    const GcodeLine line(text, GcodeRules::kGpx);
    for (const auto& [letter, number] : commands) found = found || line.is(letter, number);
    return !found;
  });
  return found;
}

// A Replicator that was not homed, does not know where home is or extrudes cold breaks something.
// What the text lacks, with the codes that would do; nothing where it is complete.
std::optional<std::string> missing_in_s3g_start(std::string_view gcode) {
  if (!has_one_of(gcode, {{'G', 161}, {'G', 162}, {'G', 28}})) return "homing (G161, G162 or G28)";
  if (!has_one_of(gcode, {{'M', 132}})) return "the recall of the home position (M132)";
  if (!has_one_of(gcode, {{'M', 133}, {'M', 116}, {'M', 109}, {'M', 6}}))
    return "a wait for the heat (M133, M116, M109 or M6)";
  return std::nullopt;
}

void check_s3g_start(const Profile& profile) {
  const std::optional<std::string> missing = missing_in_s3g_start(profile.slicer.start_gcode);
  if (!missing) return;
  throw Error(Fault::kBadProfile,
              fmt::format("Profile {}: slicer.start_gcode lacks {}", profile.id, *missing),
              "Add it to the profile's start text; nothing is made that could harm the machine.");
}

void check_volume(const Profile& profile, std::string_view gcode) {
  const std::optional<MoveFault> fault =
      check_moves(gcode, machine_volume(profile), gcode_rules(profile));
  if (!fault) return;
  throw Error(
      Fault::kBadProfile,
      fmt::format("Line {} of the program, \"{}\", {}", fault->line, fault->command, fault->what),
      "Leave more room at the sides of the tray, or correct slicer.options, start_gcode "
      "and end_gcode in the profile.");
}

// What gpx names the build after: the file's name.
std::string file_name(const std::string& build_name) {
  std::string name = build_name.substr(0, kMaxNameLength);
  for (char& c : name)
    if (std::isalnum(static_cast<unsigned char>(c)) == 0 &&
        std::string_view(" -_.").find(c) == std::string_view::npos)
      c = '_';
  // no name may be hidden, empty or an option of gpx
  const std::size_t first = name.find_first_not_of(" -.");
  name = first == std::string::npos ? "PackMerger" : name.substr(first);
  return name;
}

std::string to_x3g(const Profile& profile, const std::string& gcode, const std::string& build_name,
                   const Progress& progress) {
  const TemporaryFolder folder;
  write_file_whole(folder.path() / "program.gcode", gcode);
  const std::string name = file_name(build_name) + ".x3g";
  ProcessSpec spec;
  spec.argv = {"gpx", "-I", "-p", "-m", profile.slicer.gpx_machine, "program.gcode", name};
  spec.set_env = {{"LC_ALL", "C"}};
  spec.folder = folder.path();
  ProcessResult result;
  try {
    result = run_process(spec, kTimeoutS, progress);
  } catch (const Error& error) {
    if (error.fault() != Fault::kUnavailable) throw;
    throw Error(Fault::kUnavailable, "gpx is not installed", "Run: apt-get install gpx");
  }
  std::string bytes;
  if (result.status.ok() && fs::exists(folder.path() / name))
    bytes = read_file(folder.path() / name, kMaxProgramBytes);
  // the last command of a whole program is the end of the build and its one byte
  if (bytes.size() < 2 || bytes[bytes.size() - 2] != kEndOfBuild)
    throw Error(
        Fault::kBadProfile,
        fmt::format("gpx cannot convert the program for machine \"{}\": {}",
                    profile.slicer.gpx_machine, result.err.substr(0, result.err.find("\n\n"))),
        "Correct slicer.gpx_machine, start_gcode and end_gcode in the profile.");
  return bytes;
}

}  // namespace

std::string converted_to_x3g(const Profile& profile, const std::string& gcode,
                             const std::string& build_name, const Progress& progress) {
  if (const std::optional<std::string> missing = missing_in_s3g_start(gcode))
    throw Error(Fault::kBadInput, "The program lacks " + *missing + ", and could harm the machine",
                "Let the slicer write the machine's own start text, or give it an .x3g file.");
  return to_x3g(profile, gcode, build_name, progress);
}

std::optional<Program> make_program(const Profile& profile, const Tray& tray,
                                    const std::string& build_name, const Progress& progress) {
  if (!profile.is_sliced()) return std::nullopt;
  if (profile.dialect == Dialect::kS3g) check_s3g_start(profile);
  SlicedTray sliced = slice(profile, tray, SliceFlavour::kProgram, progress);
  check_volume(profile, sliced.gcode);

  Program program;
  if (sliced.skirt_left_out)
    program.warnings.push_back(
        {"skirt_left_out",
         "The skirt that primes the nozzle is left out: the tray has no room for it."});
  program.extension = profile.dialect == Dialect::kS3g ? "x3g" : "gcode";
  program.bytes = profile.dialect == Dialect::kS3g
                      ? to_x3g(profile, sliced.gcode, build_name, progress)
                      : sliced.gcode;
  program.gcode = std::move(sliced.gcode);
  return program;
}

}  // namespace packmerger
