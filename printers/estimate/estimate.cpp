#include "printers/estimate/estimate.h"

#include "printers/estimate/linear_estimate.h"
#include "printers/price.h"

namespace packmerger {
namespace {

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

}  // namespace packmerger
