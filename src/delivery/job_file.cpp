#include "delivery/job_file.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <utility>

#include "base/error.h"
#include "base/names.h"

namespace packmerger {
namespace {

constexpr std::array<std::pair<std::string_view, FileKind>, 11> kEndings = {{
    {".stl", FileKind::kModel},
    {".obj", FileKind::kModel},
    {".ply", FileKind::kModel},
    {".off", FileKind::kModel},
    {".gcode.3mf", FileKind::kSliced},  // before what it ends in
    {".3mf", FileKind::kModel},
    {".gcode", FileKind::kGcode},
    {".gco", FileKind::kGcode},
    {".g", FileKind::kGcode},
    {".x3g", FileKind::kX3g},
    {".s3g", FileKind::kX3g},
}};
constexpr std::size_t kLongestName = 200;

}  // namespace

FileKind kind_of_file(std::string_view name) {
  const auto same_letter = [](unsigned char a, unsigned char b) { return std::tolower(a) == b; };
  for (const auto& [ending, kind] : kEndings) {
    if (name.size() < ending.size()) continue;
    const std::string_view given = name.substr(name.size() - ending.size());
    if (std::equal(given.begin(), given.end(), ending.begin(), ending.end(), same_letter))
      return kind;
  }
  return FileKind::kUnknown;
}

std::vector<std::string_view> job_file_endings() {
  std::vector<std::string_view> endings;
  for (const auto& [ending, kind] : kEndings) endings.push_back(ending);
  return endings;
}

std::string job_file_name(std::string_view given) {
  std::string name =
      last_bytes(printable(given.substr(given.find_last_of("/\\") + 1), '_'), kLongestName);
  name.erase(0, std::min(name.find_first_not_of(". ~"), name.size()));
  if (kind_of_file(name) == FileKind::kUnknown)
    throw Error(Fault::kBadInput, "This is nothing that PackMerger takes",
                "Send a model (STL, OBJ, PLY, OFF, 3MF) or a program (G-code, x3g).");
  return name;
}

}  // namespace packmerger
