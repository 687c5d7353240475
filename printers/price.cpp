#include "printers/price.h"

namespace packmerger {
namespace {

double minutes_by_hand(const CostSettings& rates, const Assembly& assembly, int trays) {
  return rates.glue_min_per_joint * assembly.joints + rates.clean_min_per_tray * trays;
}

}  // namespace

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
