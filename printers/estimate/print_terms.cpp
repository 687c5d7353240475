#include "printers/estimate/print_terms.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "base/error.h"
#include "printers/estimate/fdm_toolpath.h"
#include "printers/estimate/polyjet.h"
#include "printers/layers/layers.h"
#include "printers/layers/support_volume.h"
#include "printers/slice/slice.h"

namespace packmerger {
namespace {

void require_positive(const Profile& profile, double value, const char* key) {
  if (value > 0) return;
  throw Error(Fault::kBadProfile,
              "Profile " + profile.id + ": " + key + " must be positive to estimate a print",
              std::string("Set ") + key + " in the profile or with --set.");
}

void require_toolpath(const Profile& profile) {
  const FdmSettings& settings = profile.fdm;
  require_positive(profile, bead(settings, profile.layer_mm).spacing_mm, "fdm.line_width_mm");
  require_positive(profile, settings.speed_mm_s, "fdm.speed_mm_s");
  require_positive(profile, settings.external_speed_mm_s, "fdm.external_speed_mm_s");
  require_positive(profile, settings.acceleration_mm_s2, "fdm.acceleration_mm_s2");
  require_positive(profile, settings.min_speed_mm_s, "fdm.min_speed_mm_s");
}

double bed_mm3(const Profile& profile, double height_mm) {
  const double area_mm2 = profile.plate_mm.empty() ? profile.build_mm[0] * profile.build_mm[1]
                                                   : std::abs(signed_area_mm2(profile.plate_mm));
  return area_mm2 * height_mm;
}

BothTerms terms_of(const Profile& profile, const Tray& tray) {
  std::vector<const Mesh*> parts;
  for (const Mesh& part : tray.parts) parts.push_back(&part);
  PrintTerms terms;
  terms.by = estimator_of(profile);
  if (terms.by == Estimator::kPath) {
    add_tool_path(terms, profile, parts);
    return {terms, terms};
  }
  terms.layers = layer_count(top_of(parts), profile.layer_mm);
  for (const Mesh* part : parts) terms.model_mm3 += volume_mm3(*part);
  terms.support_mm3 = support_volume_mm3(parts, radians(profile.support_angle_deg));
  terms.held_mm3 = terms.support_mm3;
  if (terms.by == Estimator::kPowder) terms.bed_mm3 = bed_mm3(profile, top_of(parts));
  BothTerms both{terms, terms};
  if (terms.by == Estimator::kPolyjet) add_passes(both, profile, parts);
  return both;
}

}  // namespace

Estimator estimator_of(const Profile& profile) {
  if (profile.technology == Technology::kPolyjet) return Estimator::kPolyjet;
  if (profile.technology == Technology::kPowder) return Estimator::kPowder;
  return profile.fdm.time == FdmTime::kDeposition ? Estimator::kDeposition : Estimator::kPath;
}

Estimator taught_estimator_of(const Profile& profile) {
  return profile.is_sliced() ? Estimator::kPath : estimator_of(profile);
}

PrintTerms& PrintTerms::operator+=(const PrintTerms& other) {
  trays += other.trays;
  layers += other.layers;
  passes += other.passes;
  passes_mm += other.passes_mm;
  model_mm3 += other.model_mm3;
  support_mm3 += other.support_mm3;
  held_mm3 += other.held_mm3;
  bed_mm3 += other.bed_mm3;
  path_s += other.path_s;
  return *this;
}

BothTerms both_terms(const Profile& profile, const std::vector<Tray>& trays,
                     const Progress& progress) {
  require_constants(profile);
  BothTerms sum;
  sum.straight.by = sum.turned.by = estimator_of(profile);
  sum.straight.trays = sum.turned.trays = 0;
  for (const Tray& tray : trays) {
    progress.check();
    const BothTerms one = terms_of(profile, tray);
    sum.straight += one.straight;
    sum.turned += one.turned;
  }
  progress.check();
  return sum;
}

PrintTerms print_terms(const Profile& profile, const std::vector<Tray>& trays,
                       const Progress& progress) {
  if (!profile.is_sliced()) return both_terms(profile, trays, progress).straight;
  PrintTerms terms;
  terms.by = Estimator::kPath;
  terms.trays = static_cast<int>(trays.size());
  terms.path_s = estimate_by_slicer(profile, trays, {}, progress).time_s -
                 static_cast<double>(terms.trays) * profile.fdm.start_s;
  return terms;
}

PrintTerms predicted_terms(const Profile& profile, const TrayMeasure& tray) {
  PrintTerms terms;
  terms.by = estimator_of(profile);
  terms.layers = layer_count(tray.size_mm.z(), profile.layer_mm);
  terms.model_mm3 = tray.material_mm3;
  terms.support_mm3 = terms.held_mm3 = tray.support_mm3;
  if (terms.by == Estimator::kPolyjet)
    add_passes(terms, profile.polyjet, terms.layers, tray.size_mm.x(), tray.size_mm.y());
  if (terms.by == Estimator::kPowder) terms.bed_mm3 = bed_mm3(profile, tray.size_mm.z());
  if (terms.by == Estimator::kPath) {
    const FdmSettings& settings = profile.fdm;
    const double path_mm = tray.material_mm3 / bead(settings, profile.layer_mm).area_mm2;
    const double beads_s = (1 + settings.overhead_factor) * path_mm / settings.speed_mm_s;
    const double slowest_s =
        std::min(terms.layers * settings.min_layer_s, path_mm / settings.min_speed_mm_s);
    terms.path_s = std::max(beads_s, slowest_s) +
                   support_time_s(settings, profile.layer_mm, tray.support_mm3, 0);
  }
  return terms;
}

void require_constants(const Profile& profile) {
  require_positive(profile, profile.layer_mm, "layer_mm");
  switch (estimator_of(profile)) {
    case Estimator::kPolyjet:
      return require_positive(profile, profile.polyjet.swath_mm, "polyjet.swath_mm");
    case Estimator::kPowder:
      return require_positive(profile, profile.powder.layer_s, "powder.layer_s");
    case Estimator::kDeposition:
      return require_positive(profile, profile.fdm.deposition_cm3_h, "fdm.deposition_cm3_h");
    case Estimator::kPath:
      return require_toolpath(profile);
  }
}

}  // namespace packmerger
