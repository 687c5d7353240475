#include "gcode/program_text.h"

#include <algorithm>
#include <array>
#include <cctype>

#include "base/error.h"
#include "base/storage/zip_archive.h"

namespace packmerger {
namespace {

using namespace std::string_view_literals;

constexpr std::uint64_t kMostInflated = std::uint64_t{1} << 30;
constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
constexpr std::size_t kLookedAt = 4096;

struct Sign {
  std::string_view start;
  const char* what;
  const char* hint;
};

constexpr const char* kUnpack = "Unpack it, and give the .gcode that is in it.";
constexpr const char* kSaveAsText = "Open it in an editor, and save it as UTF-8 or plain text.";

constexpr std::array<Sign, 11> kSigns{{
    {"GCDE"sv, "binary G-code (.bgcode)",
     "Export it as plain G-code: in PrusaSlicer, untick \"Supports binary G-code\" in the "
     "printer's "
     "settings."},
    {"\x1f\x8b"sv, "compressed by gzip", kUnpack},
    {"BZh"sv, "compressed by bzip2", kUnpack},
    {"\xFD"
     "7zXZ"sv,
     "compressed by xz", kUnpack},
    {"7z\xBC\xAF"sv, "a 7z archive", kUnpack},
    {"\x28\xB5\x2F\xFD"sv, "compressed by zstd", kUnpack},
    {"Rar!"sv, "a RAR archive", kUnpack},
    {"\xFF\xFE"sv, "UTF-16 text", kSaveAsText},
    {"\xFE\xFF"sv, "UTF-16 text", kSaveAsText},
    {"%PDF"sv, "a PDF document", "Give the program that the slicer exported."},
    {"<"sv, "a web page or XML", "Download or export the program again."},
}};

[[noreturn]] void refuse(const std::string& what, const std::string& hint) {
  throw Error(Fault::kBadInput, "This is no plain G-code: it is " + what, hint);
}

// Every other byte of ASCII in UTF-16 is 0.
bool is_utf16(std::string_view start) {
  std::array<std::size_t, 2> zeros{};
  for (std::size_t i = 0; i < start.size(); ++i)
    if (start[i] == '\0') ++zeros[i % 2];
  return std::max(zeros[0], zeros[1]) > start.size() / 3 && std::min(zeros[0], zeros[1]) == 0;
}

void check_is_text(std::string_view bytes) {
  for (const Sign& sign : kSigns)
    if (bytes.starts_with(sign.start)) refuse(sign.what, sign.hint);
  const std::string_view start = bytes.substr(0, kLookedAt);
  if (is_utf16(start)) refuse("UTF-16 text", kSaveAsText);
  if (start.find('\0') != std::string_view::npos)
    refuse("binary data", "Give the program that the slicer exported; x3g is named .x3g.");
}

bool is_plate(std::string_view name) {
  constexpr std::string_view kFolder = "metadata/plate_";
  constexpr std::string_view kEnding = ".gcode";
  std::string lower(name);
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return lower.starts_with(kFolder) && lower.ends_with(kEnding);
}

std::vector<std::string> plates_of(const ZipArchive& archive) {
  std::vector<std::string> plates = archive.names();
  plates.erase(std::remove_if(plates.begin(), plates.end(),
                              [](const std::string& name) { return !is_plate(name); }),
               plates.end());
  std::sort(plates.begin(), plates.end());
  return plates;
}

std::string program_of_archive(std::string_view bytes) {
  ZipArchive archive(bytes, kMostInflated);
  const std::vector<std::string> plates = plates_of(archive);
  if (plates.empty())
    refuse("a ZIP archive without a sliced plate (Metadata/plate_1.gcode)",
           "In Orca or Bambu Studio slice it and export the sliced plate file; a model is named "
           ".3mf; otherwise unpack it.");
  if (plates.size() > 1)
    throw Error(Fault::kBadInput,
                "The file holds the programs of " + std::to_string(plates.size()) +
                    " plates, and nobody says which is meant",
                "Export each plate by itself (\"Export plate sliced file\").");
  return archive.entry(plates.front()).value_or("");
}

}  // namespace

std::vector<std::string> sliced_plates(std::string_view bytes) {
  if (!ZipArchive::looks_like(bytes)) return {};
  return plates_of(ZipArchive(bytes, kMostInflated));
}

std::string program_text(std::string bytes) {
  if (ZipArchive::looks_like(bytes)) bytes = program_of_archive(bytes);
  if (bytes.starts_with(kByteOrderMark)) bytes.erase(0, kByteOrderMark.size());
  check_is_text(bytes);
  if (bytes.find('\n') == std::string::npos) std::replace(bytes.begin(), bytes.end(), '\r', '\n');
  return bytes;
}

}  // namespace packmerger
