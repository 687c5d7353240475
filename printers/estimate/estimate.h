// What printing some trays takes, predicted without a slicer. docs/ESTIMATES.md has the formulas,
// where the constants come from and what accuracy to expect.
#pragma once

#include <vector>

#include "base/progress.h"
#include "model/estimate.h"
#include "model/printer.h"
#include "model/tray.h"

namespace packmerger {

// Time and material by the profile's estimator: PolyJet (layers × swaths), FDM by deposition rate,
// or FDM by tool path, as technology and fdm.time say. Figures are sums over the trays, cost
// included. support_mm3 is V_s. source = kModel. Throws Error{kBadProfile} when a constant the
// estimator divides by is not positive, Error{kInterrupted}.
Estimate estimate(const Profile& profile, const std::vector<Tray>& trays, const Assembly& assembly,
                  const Progress& progress);

// The same for trays as they stand and turned by a quarter about the vertical, for little more than
// the price of one: only a PolyJet's passes tell the difference.
struct BothTurns {
  Estimate straight;
  Estimate turned;
};
BothTurns estimate_both_turns(const Profile& profile, const std::vector<Tray>& trays,
                              const Assembly& assembly, const Progress& progress);

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
