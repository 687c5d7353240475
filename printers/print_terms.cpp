#include "printers/print_terms.h"

#include "printers/estimate.h"
#include "printers/layer_extents.h"
#include "printers/layers.h"
#include "printers/polyjet.h"
#include "printers/slice.h"
#include "printers/support_volume.h"
#include "printers/tray_estimate.h"

namespace packmerger {
namespace {

void add_passes(PrintTerms& terms, const Profile& profile, const Tray& tray, double angle) {
  for (const auto& extent : layer_extents(pointers(tray), profile.layer_mm, angle)) {
    const Vec2 size = extent.isEmpty() ? Vec2(0, 0) : Vec2(extent.sizes());
    const double passes = polyjet_passes(profile.polyjet, size.y());
    terms.passes += passes;
    terms.passes_mm += passes * size.x();
  }
}

double other_time_s(const Profile& profile, const std::vector<Tray>& trays,
                    const Progress& progress) {
  const Estimate whole = profile.is_sliced() ? estimate_by_slicer(profile, trays, {}, progress)
                                             : estimate(profile, trays, {}, progress);
  return whole.time_s - static_cast<double>(trays.size()) * profile.fdm.start_s;
}

}  // namespace

TimeTerms time_terms(const Profile& profile) {
  if (profile.is_sliced()) return TimeTerms::kOther;
  if (profile.technology == Technology::kPolyjet) return TimeTerms::kLayersAndPasses;
  return profile.fdm.time == FdmTime::kDeposition ? TimeTerms::kDeposition : TimeTerms::kOther;
}

PrintTerms print_terms(const Profile& profile, const std::vector<Tray>& trays,
                       const Progress& progress) {
  PrintTerms terms;
  terms.trays = static_cast<int>(trays.size());
  const TimeTerms kind = time_terms(profile);
  if (kind == TimeTerms::kOther) {
    terms.other_s = other_time_s(profile, trays, progress);
    return terms;
  }
  require_positive(profile, profile.layer_mm, "layer_mm");
  const double angle = radians(profile.support_angle_deg);
  if (kind == TimeTerms::kLayersAndPasses)
    require_positive(profile, profile.polyjet.swath_mm, "polyjet.swath_mm");
  for (const Tray& tray : trays) {
    progress.check();
    terms.layers += layer_count(height_mm(tray), profile.layer_mm);
    if (kind == TimeTerms::kLayersAndPasses) add_passes(terms, profile, tray, angle);
    terms.model_mm3 += matter_mm3(tray);
    terms.support_mm3 += support_volume_mm3(pointers(tray), angle);
  }
  return terms;
}

double time_of(const Profile& profile, const PrintTerms& terms) {
  const PolyjetSettings& jet = profile.polyjet;
  const FdmSettings& fdm = profile.fdm;
  switch (time_terms(profile)) {
    case TimeTerms::kLayersAndPasses:
      return terms.trays * jet.start_s + terms.layers * jet.layer_s + terms.passes * jet.swath_s +
             terms.passes_mm * jet.per_mm_x_s;
    case TimeTerms::kDeposition:
      return deposition_s(fdm, terms);
    case TimeTerms::kOther:
      break;
  }
  return terms.trays * fdm.start_s + terms.other_s;
}

double deposition_s(const FdmSettings& fdm, const PrintTerms& terms) {
  return terms.trays * fdm.start_s +
         (terms.model_mm3 + terms.support_mm3 * fdm.support_fill_fraction) / 1000 /
             fdm.deposition_cm3_h * 3600 +
         terms.layers * fdm.layer_s;
}

double model_g_of(const Profile& profile, const PrintTerms& terms) {
  const double waste =
      profile.technology == Technology::kPolyjet ? profile.polyjet.model_waste_factor : 1;
  return terms.model_mm3 * waste / 1000 * profile.material.model_density_g_cm3;
}

double support_g_of(const Profile& profile, const PrintTerms& terms) {
  if (profile.technology == Technology::kPolyjet)
    return terms.support_mm3 / 1000 * profile.polyjet.support_g_per_cm3;
  return terms.support_mm3 * profile.fdm.support_fill_fraction / 1000 *
         profile.material.support_density_g_cm3;
}

}  // namespace packmerger
