// The conductor of the first half of shape: from the model's surface to tetrahedra.
#pragma once

#include <optional>

#include "base/progress.h"
#include "model/printer.h"
#include "model/shell.h"
#include "model/tet_mesh.h"
#include "model/warning.h"

namespace packmerger {

struct Solidified {
  Shell shell;
  TetMesh tets;
  // Where the surface was re-sampled: settings.resample_tolerance_mm. The measured deviation, which
  // is smaller, stands in the warning "resampled".
  std::optional<double> resample_tolerance_mm;
};

// model: as repair() returns it, mm. hollow_it false: no cavities are made.
// A surface that intersects itself, or that TetGen refuses, is re-sampled.
// Warnings: "resampled", "shape_changed" where that moved the surface by more than 1 % of the
// longest side, and those of hollow(). Throws Error{kBadInput} when no tetrahedra can be made.
Solidified solidify(const Mesh& model, const ShapeSettings& settings, bool hollow_it,
                    Warnings& warnings, const Progress& progress);

}  // namespace packmerger
