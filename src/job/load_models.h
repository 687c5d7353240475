// From files to closed surfaces in millimetres: the first step of prepare and compare.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "base/progress.h"
#include "model/job.h"
#include "model/mesh.h"
#include "model/warning.h"

namespace packmerger {

// How a file's numbers become millimetres.
struct Sizing {
  double unit_mm = 1;             // for files that name no unit; 25.4 for inches
  double scale = 1;               // on top of the unit
  std::optional<double> size_mm;  // longest side; replaces unit_mm and scale
};

struct LoadedModel {
  JobInput input;
  std::shared_ptr<const Mesh> surface;  // closed, outward, mm; shared by copies of one file
};

// One entry per path, in order; a path named twice is read once. Bodies of one file that overlap
// are made one. Adds warnings "left_out", "suspicious_size" (longest side under 5 mm or over 2 m),
// and those of repair() and unite_bodies(). Throws what read_file, read_model and repair throw, and
// Error{kBadInput} where the longest side is under 0.1 mm or over 10 m, or the file is sliced.
std::vector<LoadedModel> load_models(const std::vector<std::filesystem::path>& paths,
                                     const Sizing& sizing, Warnings& warnings,
                                     const Progress& progress);

}  // namespace packmerger
