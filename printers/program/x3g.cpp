#include "printers/program/x3g.h"

#include <algorithm>
#include <cctype>
#include <charconv>

#include <fmt/format.h>

#include "base/files.h"
#include "base/process/process.h"
#include "gcode/gcode_line.h"
#include "printers/program/gpx_source.h"

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

// The line that gpx speaks of in "(line 12) Syntax warning: …", as it stands in the program.
std::string place_of(std::string_view said, std::string_view gcode) {
  constexpr std::string_view kLine = "(line ";
  int wanted = 0;
  if (said.starts_with(kLine))
    std::from_chars(said.data() + kLine.size(), said.data() + said.size(), wanted);
  std::string place;
  for_each_line(gcode, [&](std::string_view text, int number) {
    if (number == wanted)
      place = fmt::format("Line {} of the program, \"{}\": ", number, shown_line(text));
    return number < wanted;
  });
  return place;
}

// gpx goes on after whatever it did not understand: nothing it warned of is sent.
void judge(const ProcessResult& result, std::string_view gcode, Fault fault) {
  const std::string_view said = std::string_view(result.err).substr(0, result.err.find('\n'));
  if (said.empty()) return;
  throw Error(fault, fmt::format("{}gpx cannot convert it whole: {}", place_of(said, gcode), said),
              "Take out what it does not know, or convert the program yourself and give the .x3g.");
}

}  // namespace

std::optional<std::string> missing_in_s3g_start(std::string_view gcode) {
  if (!has_one_of(gcode, {{'G', 161}, {'G', 162}, {'G', 28}})) return "homing (G161, G162 or G28)";
  if (!has_one_of(gcode, {{'M', 132}})) return "the recall of the home position (M132)";
  if (!has_one_of(gcode, {{'M', 133}, {'M', 116}, {'M', 109}, {'M', 6}}))
    return "a wait for the heat (M133, M116, M109 or M6)";
  return std::nullopt;
}

X3g to_x3g(const Profile& profile, const std::string& gcode, const std::string& build_name,
           Fault fault, const Progress& progress) {
  GpxSource source = gpx_source(gcode, fault);
  const TemporaryFolder folder;
  write_file_whole(folder.path() / "program.gcode", source.gcode);
  const std::string name = file_name(build_name) + ".x3g";
  ProcessSpec spec;
  spec.argv = {"gpx",
               "-I",
               "-p",
               source.makerbot_flavour ? "-g" : "-r",
               "-m",
               profile.slicer.gpx_machine,
               "program.gcode",
               name};
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
  if (result.status.ok()) judge(result, gcode, fault);
  if (result.status.ok() && fs::exists(folder.path() / name))
    bytes = read_file(folder.path() / name, kMaxProgramBytes);
  // the last command of a whole program is the end of the build and its one byte
  if (bytes.size() < 2 || bytes[bytes.size() - 2] != kEndOfBuild)
    throw Error(
        Fault::kBadProfile,
        fmt::format("gpx cannot convert the program for machine \"{}\": {}",
                    profile.slicer.gpx_machine, result.err.substr(0, result.err.find("\n\n"))),
        "Correct slicer.gpx_machine, start_gcode and end_gcode in the profile.");
  return {std::move(bytes), std::move(source.warnings)};
}

}  // namespace packmerger
