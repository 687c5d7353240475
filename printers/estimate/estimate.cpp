#include "printers/estimate/estimate.h"

#include "printers/estimate/linear_estimate.h"

namespace packmerger {
namespace {

double minutes_by_hand(const CostSettings& rates, const Assembly& assembly, int trays) {
  return rates.glue_min_per_joint * assembly.joints + rates.clean_min_per_tray * trays;
}

Estimate from_terms(const Profile& profile, const PrintTerms& terms) {
  Estimate estimate;
  estimate.source = EstimateSource::kModel;
  estimate.trays = terms.trays;
  estimate.time_s = time_of(profile, terms);
  estimate.model_mm3 = model_mm3_of(profile, terms);
  estimate.model_g = model_g_of(profile, terms);
  estimate.support_mm3 = terms.support_mm3;
  estimate.support_g = support_g_of(profile, terms);
  return estimate;
}

}  // namespace

Estimate estimate(const Profile& profile, const std::vector<Tray>& trays, const Assembly& assembly,
                  const Progress& progress) {
  return estimate_both_turns(profile, trays, assembly, progress).straight;
}

BothTurns estimate_both_turns(const Profile& profile, const std::vector<Tray>& trays,
                              const Assembly& assembly, const Progress& progress) {
  const BothTerms terms = both_terms(profile, trays, progress);
  BothTurns both{from_terms(profile, terms.straight), from_terms(profile, terms.turned)};
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

}  // namespace packmerger
