#include "printers/estimate/packing_cost.h"

#include <algorithm>

#include "printers/estimate/linear_estimate.h"
#include "printers/price.h"

namespace packmerger {
namespace {

double paper_cost(double weight, const TrayMeasure& tray) {
  return weight * tray.size_mm.prod() + (1 - weight) * tray.support_mm3;
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
