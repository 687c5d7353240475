#include "printers/packing_cost.h"

#include <algorithm>

#include "printers/estimate.h"
#include "printers/fdm_toolpath.h"
#include "printers/layers.h"
#include "printers/polyjet.h"
#include "printers/tray_estimate.h"

namespace packmerger {
namespace {

double paper_cost(double weight, const TrayMeasure& tray) {
  return weight * tray.size_mm.prod() + (1 - weight) * tray.support_mm3;
}

// Every layer reaches as far as the whole contents.
TrayEstimate predict_polyjet(const Profile& profile, const TrayMeasure& tray) {
  const PolyjetSettings& settings = profile.polyjet;
  TrayEstimate result;
  result.time_s =
      settings.start_s + layer_count(tray.size_mm.z(), profile.layer_mm) *
                             polyjet_layer_s(settings, tray.size_mm.x(), tray.size_mm.y());
  result.model_g =
      tray.material_mm3 / 1000 * settings.model_waste_factor * profile.material.model_density_g_cm3;
  result.support_g = tray.support_mm3 / 1000 * settings.support_g_per_cm3;
  return result;
}

TrayEstimate predict_fdm(const Profile& profile, const TrayMeasure& tray) {
  const FdmSettings& settings = profile.fdm;
  const double support_laid_mm3 = tray.support_mm3 * settings.support_fill_fraction;
  const int layers = layer_count(tray.size_mm.z(), profile.layer_mm);
  TrayEstimate result;
  result.model_g = tray.material_mm3 / 1000 * profile.material.model_density_g_cm3;
  result.support_g = support_laid_mm3 / 1000 * profile.material.support_density_g_cm3;
  if (settings.time == FdmTime::kDeposition) {
    result.time_s =
        settings.start_s +
        (tray.material_mm3 + support_laid_mm3) / 1000 / settings.deposition_cm3_h * 3600 +
        layers * settings.layer_s;
    return result;
  }
  // The surface is not known here, so thin walls are assumed: solid, all beads at full speed. It is
  // the same for every packing of the same parts, except where layers get too short.
  const double path_mm = tray.material_mm3 / bead(settings, profile.layer_mm).area_mm2;
  const double beads_s = (1 + settings.overhead_factor) * path_mm / settings.speed_mm_s;
  const double slowest_s =
      std::min(layers * settings.min_layer_s, path_mm / settings.min_speed_mm_s);
  result.time_s = settings.start_s + std::max(beads_s, slowest_s) +
                  support_time_s(settings, profile.layer_mm, tray.support_mm3, 0);
  return result;
}

void check_constants(const Profile& profile) {
  require_positive(profile, profile.layer_mm, "layer_mm");
  if (profile.technology == Technology::kPolyjet)
    require_positive(profile, profile.polyjet.swath_mm, "polyjet.swath_mm");
  else if (profile.fdm.time == FdmTime::kDeposition)
    require_positive(profile, profile.fdm.deposition_cm3_h, "fdm.deposition_cm3_h");
  else
    require_toolpath(profile);
}

double printer_cost(const Profile& profile, const TrayMeasure& tray) {
  const TrayEstimate predicted = profile.technology == Technology::kPolyjet
                                     ? predict_polyjet(profile, tray)
                                     : predict_fdm(profile, tray);
  const Assembly assembly{tray.parts, std::max(0, tray.parts - 1)};
  return price_of(profile.cost, predicted.model_g, predicted.support_g, predicted.time_s, assembly,
                  1)
      .sum();
}

}  // namespace

Cost packing_cost(const Profile& profile) {
  std::function<double(const TrayMeasure&)> evaluate;
  switch (profile.pack.objective) {
    case Objective::kPaper:
      evaluate = [weight = profile.pack.weight](const TrayMeasure& tray) {
        return paper_cost(weight, tray);
      };
      break;
    case Objective::kHeight:
      evaluate = [](const TrayMeasure& tray) { return tray.size_mm.z(); };
      break;
    case Objective::kPrinter:
      check_constants(profile);
      evaluate = [profile](const TrayMeasure& tray) { return printer_cost(profile, tray); };
      break;
  }
  return {evaluate, evaluate};
}

}  // namespace packmerger
