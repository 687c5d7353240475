#include "printers/estimate/packing_cost.h"

#include <algorithm>

#include "printers/estimate/estimate.h"
#include "printers/estimate/fdm_toolpath.h"
#include "printers/estimate/linear_estimate.h"
#include "printers/estimate/polyjet.h"
#include "printers/layers/layers.h"
#include "printers/price.h"

namespace packmerger {
namespace {

double paper_cost(double weight, const TrayMeasure& tray) {
  return weight * tray.size_mm.prod() + (1 - weight) * tray.support_mm3;
}

// Every layer is taken to reach as far as the whole contents. Along a tool path the surface is not
// known here, so thin walls are assumed: solid, all beads at full speed. It is the same for every
// packing of the same parts, except where layers get too short.
PrintTerms predicted_terms(const Profile& profile, const TrayMeasure& tray) {
  PrintTerms terms;
  terms.by = estimator_of(profile);
  terms.layers = layer_count(tray.size_mm.z(), profile.layer_mm);
  terms.model_mm3 = tray.material_mm3;
  terms.support_mm3 = terms.held_mm3 = tray.support_mm3;
  if (terms.by == Estimator::kPolyjet)
    add_passes(terms, profile.polyjet, terms.layers, tray.size_mm.x(), tray.size_mm.y());
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

double printer_cost(const Profile& profile, const TrayMeasure& tray) {
  const PrintTerms terms = predicted_terms(profile, tray);
  const Assembly assembly{tray.parts, std::max(0, tray.parts - 1)};
  return price_of(profile.cost, model_g_of(profile, terms), support_g_of(profile, terms),
                  time_of(profile, terms), assembly, 1)
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
      require_constants(profile);
      evaluate = [profile](const TrayMeasure& tray) { return printer_cost(profile, tray); };
      break;
  }
  return {evaluate, evaluate};
}

}  // namespace packmerger
