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

}  // namespace packmerger
