#include "shape/solid/solidify.h"

#include <cstdio>
#include <optional>
#include <string>
#include <utility>

#include "base/error.h"
#include "shape/solid/hollow.h"
#include "shape/solid/tetrahedralize.h"
#include "shape/surface/repair.h"
#include "shape/surface/resample.h"

namespace packmerger {
namespace {

// What moves a point by more than this part of the longest side changes the shape.
constexpr double kChanged = 0.01;

std::string at_most(double mm) {
  if (mm < 0.01) return "less than 0.01 mm";
  char text[32];
  std::snprintf(text, sizeof text, "at most %.2f mm", mm);
  return text;
}

// Empty when TetGen refuses. of_shell: the warnings about this attempt's shell.
std::optional<Solidified> attempt(const Mesh& outer, const ShapeSettings& settings, bool hollow_it,
                                  Warnings& of_shell, const Progress& progress) {
  of_shell.clear();
  Solidified solid;
  solid.shell =
      hollow_it ? hollow(outer, settings, of_shell, progress) : solid_shell(outer, settings);
  auto tets = tetrahedralize(solid.shell, settings, progress);
  if (!tets) return std::nullopt;
  solid.tets = std::move(*tets);
  return solid;
}

}  // namespace

Solidified solidify(const Mesh& model, const ShapeSettings& settings, bool hollow_it,
                    Warnings& warnings, const Progress& progress) {
  const double tolerance = settings.resample_tolerance_mm;
  const bool crosses = self_intersects(model);
  progress.check();
  Warnings of_shell;
  const auto with_warnings = [&](Solidified solid) {
    warnings.insert(warnings.end(), of_shell.begin(), of_shell.end());
    return solid;
  };
  if (!crosses)
    if (auto solid = attempt(model, settings, hollow_it, of_shell, progress))
      return with_warnings(std::move(*solid));

  // What crosses is first re-sampled the gentle way, by its own triangles.
  for (const bool gently : {true, false}) {
    if (gently && !crosses) continue;
    const Resampled resampled = gently ? resample(model, tolerance, progress)
                                       : resample_on_grid(model, tolerance, progress);
    auto solid = attempt(resampled.surface, settings, hollow_it, of_shell, progress);
    if (!solid) continue;
    solid->resample_tolerance_mm = tolerance;
    warnings.push_back(
        {"resampled", std::string(crosses ? "The surface intersects itself"
                                          : "No tetrahedra could be made inside the surface") +
                          ", so it was re-sampled: it deviates from the model by " +
                          at_most(resampled.deviation_mm)});
    if (resampled.deviation_mm > kChanged * bounding_box(model).sizes().maxCoeff())
      warnings.push_back({"shape_changed", "Re-sampling moved the surface by " +
                                               at_most(resampled.deviation_mm) +
                                               ", more than 1 % of the model's longest side"});
    return with_warnings(std::move(*solid));
  }
  throw Error(Fault::kBadInput, "No tetrahedra can be made of the model, re-sampled or not",
              "Repair the model in a mesh editor (remesh it with voxels) and try again.");
}

}  // namespace packmerger
