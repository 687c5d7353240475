#include "shape/solidify.h"

#include <cstdio>
#include <string>
#include <utility>

#include "base/error.h"
#include "shape/hollow.h"
#include "shape/repair.h"
#include "shape/resample.h"
#include "shape/tetrahedralize.h"

namespace packmerger {
namespace {

std::string two_digits(double number) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2f", number);
  return text;
}

// Warnings about the shell are kept only when the shell is.
std::optional<Solidified> attempt(const Mesh& outer, const ShapeSettings& settings, bool hollow_it,
                                  Warnings& warnings, const Progress& progress) {
  Warnings of_shell;
  Solidified solid;
  solid.shell = hollow_it ? hollow(outer, settings, of_shell, progress) : solid_shell(outer, settings);
  auto tets = tetrahedralize(solid.shell, settings, progress);
  if (!tets) return std::nullopt;
  solid.tets = std::move(*tets);
  warnings.insert(warnings.end(), of_shell.begin(), of_shell.end());
  return solid;
}

}  // namespace

Solidified solidify(const Mesh& model, const ShapeSettings& settings, bool hollow_it,
                    Warnings& warnings, const Progress& progress) {
  const bool crosses = self_intersects(model);
  progress.check();
  if (!crosses)
    if (auto solid = attempt(model, settings, hollow_it, warnings, progress)) return std::move(*solid);

  const Resampled resampled = resample(model, settings.resample_tolerance_mm, progress);
  warnings.push_back(
      {"resampled", std::string(crosses ? "The surface intersects itself"
                                        : "No tetrahedra could be made inside the surface") +
                        ", so it was re-sampled: it deviates from the model by at most " +
                        two_digits(resampled.deviation_mm) + " mm"});
  auto solid = attempt(resampled.surface, settings, hollow_it, warnings, progress);
  if (!solid)
    throw Error(Fault::kBadInput, "No tetrahedra can be made of the model, re-sampled or not",
                "Repair the model in a mesh editor (remesh it with voxels) and try again.");
  solid->resample_tolerance_mm = settings.resample_tolerance_mm;
  return std::move(*solid);
}

}  // namespace packmerger
