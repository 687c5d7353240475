#include "job/load_models.h"

#include <fmt/format.h>

#include <map>
#include <string_view>

#include "base/files.h"
#include "gcode/program_text.h"
#include "shape/read/read_model.h"
#include "shape/surface/repair.h"
#include "shape/surface/unite_bodies.h"

namespace packmerger {
namespace {

constexpr double kSmallest = 5;    // mm; models drawn in units of one are often two of them long
constexpr double kLargest = 2000;  // mm
// Outside of these no printer makes a model, and a wrong unit is the only explanation.
constexpr double kUnbelievablySmall = 0.1;  // mm
constexpr double kUnbelievablyLarge = 10000;

double factor(const ModelFile& file, const Sizing& sizing) {
  if (sizing.size_mm) {
    Box3 box;  // of what is printed: points may stand about that no triangle needs
    for (const auto& triangle : file.soup.triangles)
      for (const int corner : triangle) box.extend(file.soup.points[corner]);
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
void refuse_sliced(std::string_view bytes, const std::string& name) {
  if (sliced_plates(bytes).empty()) return;
  throw Error(Fault::kBadInput, name + " holds a sliced program beside or instead of a model",
              "Name it .gcode.3mf to have the program printed as it is, or export the model.");
}

LoadedModel load_model(const std::filesystem::path& path, const Sizing& sizing, Warnings& warnings,
                       const Progress& progress) {
  progress.report("reading", 0);
  LoadedModel loaded;
  loaded.input.file = path.filename().string();
  ModelFile file;
  {
    const std::string bytes = read_file(path, kMaxModelBytes);
    refuse_sliced(bytes, loaded.input.file);
    file = read_model(bytes, path, progress);
    loaded.input.sha256 = sha256_hex(bytes);
  }
  loaded.input.scale = factor(file, sizing);
  if (!(std::isfinite(loaded.input.scale) && loaded.input.scale > 0))
    throw Error(Fault::kBadInput, loaded.input.file + " has no extent, so it cannot be scaled",
                "Export the model again and check that it is not empty.");
  for (Vec3& point : file.soup.points) point *= loaded.input.scale;
  progress.report("repairing", 0);
  loaded.surface = std::make_shared<const Mesh>(
      unite_bodies(repair(file.soup, warnings, progress), warnings, progress));
  if (!file.left_out.empty())
    warnings.push_back(
        {"left_out", loaded.input.file + ": " + file.left_out + " left out, the rest is printed"});
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
