// The estimators' formulas (docs/ESTIMATES.md), each a sum of constants of the profile times
// figures of the trays. The one place where they stand: estimate() and packing_cost() add them up,
// calibrate() fits their constants.
#pragma once

#include <span>
#include <string_view>

#include "printers/estimate/print_terms.h"

namespace packmerger {

struct LinearTerm {
  std::string_view key;                // the profile's; empty where it is no constant's
  double (*constant)(const Profile&);  // in the form in which the sum is linear
  double (*amount)(const Profile&, const PrintTerms&);  // not negative
};

struct LinearEstimate {
  std::span<const LinearTerm> time_s;
  std::span<const LinearTerm> model_mm3;  // as deposited
  std::span<const LinearTerm> support_g;
};
const LinearEstimate& linear_estimate(Estimator estimator);

// The sums. Where print_terms() sliced, masses are 0: no constant of a profile makes them.
double time_of(const Profile& profile, const PrintTerms& terms);
double model_mm3_of(const Profile& profile, const PrintTerms& terms);
double model_g_of(const Profile& profile, const PrintTerms& terms);
double support_g_of(const Profile& profile, const PrintTerms& terms);

}  // namespace packmerger
