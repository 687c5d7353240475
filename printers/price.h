// What a print costs by the profile's rates: material, the machine's hours, the work of hands.
#pragma once

#include "model/estimate.h"
#include "model/printer.h"
#include "model/tray.h"

namespace packmerger {

// What is to be paid, in the profile's currency.
struct Money {
  double material = 0;
  double machine = 0;  // its hours
  double hands = 0;    // gluing the joints, cleaning the trays

  double sum() const { return material + machine + hands; }
};
Money price_of(const CostSettings& rates, double model_g, double support_g, double time_s,
               const Assembly& assembly, int trays);

// Fills parts, assembly_min (gluing and cleaning), the cost and its three sums, and currency from
// the time, material and trays that stand in the estimate.
void price(Estimate& estimate, const Profile& profile, const Assembly& assembly);

}  // namespace packmerger
