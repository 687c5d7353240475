#include "job/load_models.h"

#include <fmt/format.h>

#include <array>
#include <fstream>
#include <map>

#include "base/files.h"
#include "base/zip_archive.h"
#include "gcode/program_text.h"
#include "shape/read_model.h"
#include "shape/repair.h"

namespace packmerger {
namespace {

constexpr double kSmallest = 5;    // mm; models drawn in units of one are often two of them long
constexpr double kLargest = 2000;  // mm
constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 30;  // what read_model takes
// Outside of these no printer makes a model, and a wrong unit is the only explanation.
constexpr double kUnbelievablySmall = 0.1;  // mm
constexpr double kUnbelievablyLarge = 10000;

double factor(const ModelFile& file, const Sizing& sizing) {
  if (sizing.size_mm) {
    Box3 box;
    for (const Vec3& point : file.soup.points) box.extend(point);
    return *sizing.size_mm / box.sizes().maxCoeff();
  }
  return sizing.scale * (file.has_unit ? 1 : sizing.unit_mm);
}

void check_size(const std::string& name, const Mesh& surface, Warnings& warnings) {
  const Vec3 size = bounding_box(surface).sizes();
  const double longest = size.maxCoeff();
  if (longest < kUnbelievablySmall || longest > kUnbelievablyLarge)
    throw Error(Fault::kBadInput,
                fmt::format("{} measures {:.6g} x {:.6g} x {:.6g} mm, which no printer can make",
                            name, size.x(), size.y(), size.z()),
                "Check the model's unit, and use --units, --scale or --size where it is wrong.");
  if (longest >= kSmallest && longest <= kLargest) return;
  warnings.push_back(
      {"suspicious_size",
       fmt::format("{} measures {:.4g} x {:.4g} x {:.4g} mm: check its unit, and use "
                   "--units, --scale or --size if that is wrong",
                   name, size.x(), size.y(), size.z())});
}

// A sliced file's model may be there too, or not: what its maker sees is the program.
void refuse_sliced(const std::filesystem::path& path) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) return;  // a pipe may never end
  std::array<char, 4> start{};
  std::ifstream(path, std::ios::binary).read(start.data(), start.size());
  if (!ZipArchive::looks_like({start.data(), start.size()})) return;
  if (sliced_plates(read_file(path, kMostBytes)).empty()) return;
  throw Error(Fault::kBadInput,
              path.filename().string() + " holds a sliced program beside or instead of a model",
              "Name it .gcode.3mf to have the program printed as it is, or export the model.");
}

LoadedModel load_model(const std::filesystem::path& path, const Sizing& sizing, Warnings& warnings,
                       const Progress& progress) {
  progress.report("reading", 0);
  refuse_sliced(path);
  ModelFile file = read_model(path, progress);
  LoadedModel loaded;
  loaded.input.file = path.filename().string();
  loaded.input.sha256 = sha256_hex_of_file(path);
  loaded.input.scale = factor(file, sizing);
  if (!(std::isfinite(loaded.input.scale) && loaded.input.scale > 0))
    throw Error(Fault::kBadInput, loaded.input.file + " has no extent, so it cannot be scaled",
                "Export the model again and check that it is not empty.");
  for (Vec3& point : file.soup.points) point *= loaded.input.scale;
  progress.report("repairing", 0);
  loaded.surface = std::make_shared<const Mesh>(repair(file.soup, warnings, progress));
  if (!file.left_out.empty())
    warnings.push_back({"left_out", loaded.input.file + ": " + file.left_out +
                                        " of the slicer's project left out, the rest is printed"});
  check_size(loaded.input.file, *loaded.surface, warnings);
  return loaded;
}

}  // namespace

std::vector<LoadedModel> load_models(const std::vector<std::filesystem::path>& paths,
                                     const Sizing& sizing, Warnings& warnings,
                                     const Progress& progress) {
  std::map<std::filesystem::path, LoadedModel> seen;
  std::vector<LoadedModel> models;
  for (const std::filesystem::path& path : paths) {
    if (!seen.contains(path)) seen.emplace(path, load_model(path, sizing, warnings, progress));
    models.push_back(seen.at(path));
  }
  return models;
}

}  // namespace packmerger
