#include "shape/read/read_model.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <utility>

#include "base/error.h"
#include "model/files/file_format.h"
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

// What decides a file's format.
struct Beginning {
  std::string_view bytes;
  std::string_view first_word;
  std::string_view extension;  // small letters, without its dot

  bool begins(std::string_view with) const { return bytes.starts_with(with); }
};

struct MeshReader {
  std::string_view format;
  bool has_unit;  // the file says its unit, and what is read is in mm
  // Whether the bytes show the format; nullptr: it is known by its extension only.
  bool (*is_shown)(const Beginning& file);
  void (*read)(std::string_view bytes, const Progress& progress, ModelFile& file);
};

template <TriangleSoup (*reader)(std::string_view, const Progress&)>
void read_soup(std::string_view bytes, const Progress& progress, ModelFile& file) {
  file.soup = reader(bytes, progress);
}

void read_parts(std::string_view bytes, const Progress& progress, ModelFile& file) {
  Parts3mf parts = read_3mf(bytes, progress);
  file.soup = std::move(parts.soup);
  file.left_out = told(parts.left_out);
}

bool is_off(const Beginning& file) {
  constexpr std::array<std::string_view, 5> kWords = {"OFF", "COFF", "NOFF", "CNOFF", "STOFF"};
  return std::find(kWords.begin(), kWords.end(), file.first_word) != kWords.end();
}

// In the order in which they are asked. A format's ending and name stand in
// model/files/file_format.
constexpr std::array<MeshReader, 5> kReaders = {{
    {"3mf", true,
     [](const Beginning& file) { return file.begins("PK\x03\x04") || file.begins("PK\x05\x06"); },
     read_parts},
    {"stl", false,
     [](const Beginning& file) {
       return has_binary_stl_length(file.bytes) ||
              (file.first_word == "solid" && file.extension != "obj");
     },
     read_soup<read_stl>},
    {"ply", false, [](const Beginning& file) { return file.first_word == "ply"; },
     read_soup<read_ply>},
    {"off", false, is_off, read_soup<read_off>},
    {"obj", false, nullptr, read_soup<read_obj>},
}};

const MeshReader& reader_of(std::string_view bytes, const std::string& extension) {
  Beginning file{bytes, {}, extension};
  std::string_view text = bytes.substr(0, 1 << 12);
  file.first_word = take_word(text);
  for (const MeshReader& reader : kReaders)
    if (reader.is_shown != nullptr && reader.is_shown(file)) return reader;
  for (const MeshReader& reader : kReaders)
    if (reader.format == extension) return reader;
  throw Error(Fault::kBadInput, "The model file's format is not known",
              "Give an " + model_format_names(" or ") + " file.");
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
  const MeshReader& reader = reader_of(bytes, lower_case(extension));
  file.format = reader.format;
  file.has_unit = reader.has_unit;
  reader.read(bytes, progress, file);
  check(file.soup);
  progress.report("reading", 1);
  return file;
}

}  // namespace packmerger
