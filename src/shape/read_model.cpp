#include "shape/read_model.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <utility>

#include "base/error.h"
#include "shape/formats.h"

namespace packmerger {
namespace {

constexpr std::uint64_t kMaxFileBytes = std::uint64_t{1} << 30;
constexpr double kMaxCoordinate = 1e9;

std::string lower_case(std::string_view text) {
  std::string result;
  for (const char c : text)
    result += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (result.starts_with('.')) result.erase(0, 1);
  return result;
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

std::string counted(int count, const char* thing) {
  return std::to_string(count) + " " + thing + (count == 1 ? "" : "s");
}

std::string told(const Parts3mf& parts) {
  std::string text;
  if (parts.modifiers > 0) text = counted(parts.modifiers, "modifier");
  if (parts.support_helpers > 0)
    text += (text.empty() ? "" : " and ") +
            counted(parts.support_helpers, "support blocker or enforcer");
  return text;
}

void check(const TriangleSoup& soup) {
  if (soup.triangles.empty())
    throw Error(Fault::kBadInput, "The model file holds no triangles",
                "Export the model as a mesh, for example as STL or 3MF.");
  for (const Vec3& point : soup.points) {
    if (!point.allFinite()) refuse_file("it holds coordinates that are not finite numbers");
    if (point.cwiseAbs().maxCoeff() > kMaxCoordinate)
      refuse_file("it holds coordinates beyond a thousand million");
  }
}

}  // namespace

ModelFile read_model(const fs::path& path, const Progress& progress) {
  progress.report("reading", 0);
  const std::string bytes = read_file(path, kMaxFileBytes);
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
  ModelFile file;
  file.format = format_of(bytes, lower_case(extension));
  if (file.format == "stl") file.soup = read_stl(bytes, progress);
  if (file.format == "obj") file.soup = read_obj(bytes, progress);
  if (file.format == "ply") file.soup = read_ply(bytes, progress);
  if (file.format == "off") file.soup = read_off(bytes, progress);
  if (file.format == "3mf") {
    Parts3mf parts = read_3mf(bytes, progress);
    file.soup = std::move(parts.soup);
    file.left_out = told(parts);
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
