#include "model/files/file_format.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <vector>

namespace packmerger {
namespace {

constexpr std::array<FileFormat, 11> kFormats = {{
    {".stl", FileKind::kModel, "STL", FileEnd::kStl, "model/stl"},
    {".obj", FileKind::kModel, "OBJ", FileEnd::kNotTold, ""},
    {".ply", FileKind::kModel, "PLY", FileEnd::kNotTold, ""},
    {".off", FileKind::kModel, "OFF", FileEnd::kNotTold, ""},
    {".gcode.3mf", FileKind::kSliced, "G-code", FileEnd::kZip, "model/3mf"},
    {".3mf", FileKind::kModel, "3MF", FileEnd::kZip, "model/3mf"},
    {".gcode", FileKind::kGcode, "G-code", FileEnd::kNotTold, "text/x.gcode"},
    {".gco", FileKind::kGcode, "G-code", FileEnd::kNotTold, ""},
    {".g", FileKind::kGcode, "G-code", FileEnd::kNotTold, ""},
    {".x3g", FileKind::kX3g, "x3g", FileEnd::kNotTold, ""},
    {".s3g", FileKind::kX3g, "x3g", FileEnd::kNotTold, ""},
}};

bool ends_in(std::string_view name, std::string_view ending) {
  if (name.size() < ending.size()) return false;
  const std::string_view given = name.substr(name.size() - ending.size());
  return std::equal(given.begin(), given.end(), ending.begin(), ending.end(),
                    [](unsigned char a, unsigned char b) { return std::tolower(a) == b; });
}

std::string names_of(bool programs, std::string_view last) {
  const std::vector<std::string_view> names = format_names(programs);
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (i > 0) text += i + 1 == names.size() ? last : ", ";
    text += names[i];
  }
  return text;
}

}  // namespace

std::span<const FileFormat> file_formats() { return kFormats; }

const FileFormat* format_of_name(std::string_view name) {
  const FileFormat* found = nullptr;
  for (const FileFormat& format : kFormats)
    if (ends_in(name, format.ending) &&
        (found == nullptr || format.ending.size() > found->ending.size()))
      found = &format;
  return found;
}

std::vector<std::string_view> format_names(bool programs) {
  std::vector<std::string_view> names;
  for (const FileFormat& format : kFormats)
    if (is_program(format.kind) == programs &&
        std::find(names.begin(), names.end(), format.name) == names.end())
      names.push_back(format.name);
  return names;
}

std::string model_format_names(std::string_view last) { return names_of(false, last); }
std::string program_format_names(std::string_view last) { return names_of(true, last); }

}  // namespace packmerger
