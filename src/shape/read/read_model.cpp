#include "shape/read/read_model.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <utility>

#include "base/error.h"
#include "shape/read/formats.h"
#include "shape/read/utf16.h"

namespace packmerger {
namespace {

using std::literals::operator""sv;

constexpr double kMaxCoordinate = 1e9;

std::string lower_case(std::string_view text) {
  std::string result;
  for (const char c : text)
    result += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (result.starts_with('.')) result.erase(0, 1);
  return result;
}

constexpr std::string_view kUtf8Mark = "\xEF\xBB\xBF";

struct Signature {
  std::string_view bytes;  // that such files begin with
  const char* what;
  const char* hint;
};

constexpr const char* kUnpack = "Unpack it and give the model that is inside.";
constexpr const char* kAsText = "Save it as plain text (UTF-8), or export the model again.";
constexpr const char* kExport = "Export the model as a mesh, for example as STL or 3MF.";

// Files that are met under a model's name and are something else.
constexpr std::array<Signature, 12> kForeign = {{
    {"\x1F\x8B", "a file compressed by gzip", kUnpack},
    {"BZh", "a file compressed by bzip2", kUnpack},
    {"\xFD"
     "7zXZ",
     "a file compressed by xz", kUnpack},
    {"\x28\xB5\x2F\xFD", "a file compressed by zstd", kUnpack},
    {"7z\xBC\xAF", "a 7-Zip archive", kUnpack},
    {"Rar!", "a RAR archive", kUnpack},
    {"\xFF\xFE\0\0"sv, "text in UTF-32", kAsText},
    {"\0\0\xFE\xFF"sv, "text in UTF-32", kAsText},
    {"ISO-10303-21", "a STEP file", kExport},
    {"glTF", "a glTF file", kExport},
    {"BLENDER", "a Blender file", kExport},
    {"%PDF", "a PDF document", kExport},
}};

[[noreturn]] void refuse_foreign(const char* what, const char* hint) {
  throw Error(Fault::kBadInput, std::string("The model file is ") + what + ", not a mesh", hint);
}

void refuse_foreign_files(std::string_view bytes) {
  if (has_binary_stl_length(bytes)) return;  // its header may hold anything
  for (const Signature& signature : kForeign)
    if (bytes.starts_with(signature.bytes)) refuse_foreign(signature.what, signature.hint);
}

// Empty where neither content nor extension tell.
std::string format_of(std::string_view bytes, const std::string& extension) {
  if (bytes.starts_with("PK\x03\x04") || bytes.starts_with("PK\x05\x06")) return "3mf";
  if (has_binary_stl_length(bytes)) return "stl";
  std::string_view text = bytes.substr(0, 1 << 12);
  const std::string_view first = take_word(text);
  if (first == "ply") return "ply";
  if (first == "OFF" || first == "COFF" || first == "NOFF" || first == "CNOFF" || first == "STOFF")
    return "off";
  if (first == "solid" && extension != "obj") return "stl";
  for (const char* known : {"stl", "obj", "ply", "off", "3mf"})
    if (extension == known) return known;
  return "";
}

// "2 modifiers and 1 support object"; empty where nothing was left out.
std::string told(const LeftOut3mf& left_out) {
  struct Kind {
    int count;
    const char* one;
    const char* many;
  };
  const std::array<Kind, 5> kinds = {{
      {left_out.modifiers, "modifier", "modifiers"},
      {left_out.support_helpers, "support blocker or enforcer", "support blockers or enforcers"},
      {left_out.support_objects, "support object", "support objects"},
      {left_out.other_objects, "object of type \"other\"", "objects of type \"other\""},
      {left_out.unprinted_items, "item that is not to be printed",
       "items that are not to be printed"},
  }};
  std::string text;
  for (const Kind& kind : kinds)
    if (kind.count > 0)
      text += (text.empty() ? "" : " and ") + std::to_string(kind.count) + " " +
              (kind.count == 1 ? kind.one : kind.many);
  return text;
}

void check(const TriangleSoup& soup) {
  if (soup.triangles.empty())
    throw Error(Fault::kBadInput,
                soup.points.empty() ? "The model file holds no triangles"
                                    : "The model file holds points, but no triangles",
                kExport);
  for (const Vec3& point : soup.points) {
    if (!point.allFinite()) refuse_file("it holds coordinates that are not finite numbers");
    if (point.cwiseAbs().maxCoeff() > kMaxCoordinate)
      refuse_file("it holds coordinates beyond a thousand million");
  }
}

}  // namespace

ModelFile read_model(std::string_view bytes, const fs::path& path, const Progress& progress) {
  try {
    return read_model_bytes(bytes, path.extension().string(), progress);
  } catch (const Error& error) {
    if (error.fault() == Fault::kInterrupted) throw;
    throw Error(error.fault(), path.filename().string() + ": " + error.what(), error.hint());
  }
}

ModelFile read_model_bytes(std::string_view bytes, std::string_view extension,
                           const Progress& progress) {
  if (bytes.empty())
    throw Error(Fault::kBadInput, "The model file is empty",
                "Wait until it is written, or export the model again.");
  refuse_foreign_files(bytes);
  std::string text;
  if (!has_binary_stl_length(bytes)) {
    if (const auto order = utf16_order(bytes)) bytes = text = utf8_of(bytes, *order);
    if (bytes.starts_with(kUtf8Mark)) bytes.remove_prefix(kUtf8Mark.size());
  }
  ModelFile file;
  file.format = format_of(bytes, lower_case(extension));
  if (file.format == "stl") file.soup = read_stl(bytes, progress);
  if (file.format == "obj") file.soup = read_obj(bytes, progress);
  if (file.format == "ply") file.soup = read_ply(bytes, progress);
  if (file.format == "off") file.soup = read_off(bytes, progress);
  if (file.format == "3mf") {
    Parts3mf parts = read_3mf(bytes, progress);
    file.soup = std::move(parts.soup);
    file.left_out = told(parts.left_out);
  }
  if (file.format.empty())
    throw Error(Fault::kBadInput, "The model file's format is not known",
                "Give an STL, OBJ, PLY, OFF or 3MF file.");
  file.has_unit = file.format == "3mf";
  check(file.soup);
  progress.report("reading", 1);
  return file;
}

}  // namespace packmerger
