#include "printers/estimate.h"

#include <string>

#include "printers/fdm_toolpath.h"
#include "printers/layers.h"
#include "printers/tray_estimate.h"

namespace packmerger {
namespace {

TrayEstimate estimate_tray(const Profile& profile, const Tray& tray, const Progress& progress) {
  if (profile.technology == Technology::kPolyjet) return polyjet_tray(profile, tray, progress);
  TrayEstimate fdm = profile.fdm.time == FdmTime::kDeposition
                         ? fdm_deposition_tray(profile, tray, progress)
                         : fdm_toolpath_tray(profile, tray, progress);
  fdm.turned_time_s = fdm.time_s;
  return fdm;
}

double minutes_by_hand(const CostSettings& rates, const Assembly& assembly, int trays) {
  return rates.glue_min_per_joint * assembly.joints + rates.clean_min_per_tray * trays;
}

}  // namespace

Estimate estimate(const Profile& profile, const std::vector<Tray>& trays, const Assembly& assembly,
                  const Progress& progress) {
  return estimate_both_turns(profile, trays, assembly, progress).straight;
}

BothTurns estimate_both_turns(const Profile& profile, const std::vector<Tray>& trays,
                              const Assembly& assembly, const Progress& progress) {
  require_positive(profile, profile.layer_mm, "layer_mm");
  Estimate sum;
  double turned_time_s = 0;
  sum.source = EstimateSource::kModel;
  sum.trays = static_cast<int>(trays.size());
  for (const Tray& tray : trays) {
    progress.check();
    const TrayEstimate one = estimate_tray(profile, tray, progress);
    sum.time_s += one.time_s;
    turned_time_s += one.turned_time_s;
    sum.model_mm3 += one.model_mm3;
    sum.model_g += one.model_g;
    sum.support_mm3 += one.support_mm3;
    sum.support_g += one.support_g;
  }
  BothTurns both{sum, sum};
  both.turned.time_s = turned_time_s;
  price(both.straight, profile, assembly);
  price(both.turned, profile, assembly);
  return both;
}

Money price_of(const CostSettings& rates, double model_g, double support_g, double time_s,
               const Assembly& assembly, int trays) {
  return {model_g * rates.model_price_per_g + support_g * rates.support_price_per_g,
          time_s / 3600 * rates.machine_price_per_h,
          minutes_by_hand(rates, assembly, trays) / 60 * rates.labour_price_per_h};
}

void price(Estimate& estimate, const Profile& profile, const Assembly& assembly) {
  const CostSettings& rates = profile.cost;
  estimate.parts = assembly.parts;
  estimate.assembly_min = minutes_by_hand(rates, assembly, estimate.trays);
  const Money money = price_of(rates, estimate.model_g, estimate.support_g, estimate.time_s,
                               assembly, estimate.trays);
  estimate.cost = money.sum();
  estimate.material_cost = money.material;
  estimate.machine_cost = money.machine;
  estimate.hands_cost = money.hands;
  estimate.currency = rates.currency;
}

std::vector<const Mesh*> pointers(const Tray& tray) {
  std::vector<const Mesh*> parts;
  for (const Mesh& part : tray.parts) parts.push_back(&part);
  return parts;
}

double matter_mm3(const Tray& tray) {
  double sum = 0;
  for (const Mesh& part : tray.parts) sum += volume_mm3(part);
  return sum;
}

double height_mm(const Tray& tray) { return top_of(pointers(tray)); }

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

}  // namespace packmerger
