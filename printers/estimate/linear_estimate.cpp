#include "printers/estimate/linear_estimate.h"

#include <algorithm>

namespace packmerger {
namespace {

using P = const Profile&;
using T = const PrintTerms&;

double one(P) { return 1; }

constexpr LinearTerm kPolyjetTime[] = {
    {"polyjet.start_s", [](P p) { return p.polyjet.start_s; },
     [](P, T t) { return static_cast<double>(t.trays); }},
    {"polyjet.layer_s", [](P p) { return p.polyjet.layer_s; }, [](P, T t) { return t.layers; }},
    {"polyjet.swath_s", [](P p) { return p.polyjet.swath_s; }, [](P, T t) { return t.passes; }},
    {"polyjet.per_mm_x_s", [](P p) { return p.polyjet.per_mm_x_s; },
     [](P, T t) { return t.passes_mm; }},
};
constexpr LinearTerm kPolyjetModel[] = {
    {"polyjet.model_waste_factor", [](P p) { return p.polyjet.model_waste_factor; },
     [](P, T t) { return t.model_mm3; }},
};
constexpr LinearTerm kPolyjetSupport[] = {
    {"polyjet.support_g_per_cm3", [](P p) { return p.polyjet.support_g_per_cm3; },
     [](P, T t) { return t.held_mm3 / 1000; }},
};

// A new bed of the same mass needs so much new powder: of what was heated and not fused, more is
// left than it takes where less was fused.
double lost_powder_g(P p, T t) {
  const double fused_g = t.model_mm3 / 1000 * p.material.model_density_g_cm3;
  const double loose_g = (t.bed_mm3 - t.model_mm3) / 1000 * p.material.support_density_g_cm3;
  return std::max(0.0, p.powder.refresh_fraction * (fused_g + loose_g) - fused_g);
}

constexpr LinearTerm kPowderTime[] = {
    {"powder.start_s", [](P p) { return p.powder.start_s; },
     [](P, T t) { return static_cast<double>(t.trays); }},
    {"powder.layer_s", [](P p) { return p.powder.layer_s; }, [](P, T t) { return t.layers; }},
};
constexpr LinearTerm kPowderModel[] = {{"", one, [](P, T t) { return t.model_mm3; }}};
constexpr LinearTerm kPowderLost[] = {{"", one, lost_powder_g}};

constexpr LinearTerm kFdmStart{"fdm.start_s", [](P p) { return p.fdm.start_s; },
                               [](P, T t) { return static_cast<double>(t.trays); }};
constexpr LinearTerm kDepositionTime[] = {
    kFdmStart,
    {"fdm.deposition_cm3_h", [](P p) { return 3600 / p.fdm.deposition_cm3_h; },  // s/cm³
     [](P p, T t) { return (t.model_mm3 + p.fdm.support_fill_fraction * t.held_mm3) / 1000; }},
    {"fdm.layer_s", [](P p) { return p.fdm.layer_s; }, [](P, T t) { return t.layers; }},
};
constexpr LinearTerm kPathTime[] = {kFdmStart, {"", one, [](P, T t) { return t.path_s; }}};
constexpr LinearTerm kFdmModel[] = {{"", one, [](P, T t) { return t.model_mm3; }}};
constexpr LinearTerm kFdmSupport[] = {
    {"fdm.support_fill_fraction", [](P p) { return p.fdm.support_fill_fraction; },
     [](P p, T t) { return t.held_mm3 / 1000 * p.material.support_density_g_cm3; }},
};

constexpr LinearEstimate kPolyjet{kPolyjetTime, kPolyjetModel, kPolyjetSupport};
constexpr LinearEstimate kPowder{kPowderTime, kPowderModel, kPowderLost};
constexpr LinearEstimate kDeposition{kDepositionTime, kFdmModel, kFdmSupport};
constexpr LinearEstimate kPath{kPathTime, kFdmModel, kFdmSupport};

double sum(std::span<const LinearTerm> linear, const Profile& profile, const PrintTerms& terms) {
  double sum = 0;
  for (const LinearTerm& term : linear) sum += term.constant(profile) * term.amount(profile, terms);
  return sum;
}

}  // namespace

const LinearEstimate& linear_estimate(Estimator estimator) {
  if (estimator == Estimator::kPolyjet) return kPolyjet;
  if (estimator == Estimator::kPowder) return kPowder;
  return estimator == Estimator::kDeposition ? kDeposition : kPath;
}

double time_of(const Profile& profile, const PrintTerms& terms) {
  return sum(linear_estimate(terms.by).time_s, profile, terms);
}

double model_mm3_of(const Profile& profile, const PrintTerms& terms) {
  return sum(linear_estimate(terms.by).model_mm3, profile, terms);
}

double model_g_of(const Profile& profile, const PrintTerms& terms) {
  return model_mm3_of(profile, terms) / 1000 * profile.material.model_density_g_cm3;
}

double support_g_of(const Profile& profile, const PrintTerms& terms) {
  return sum(linear_estimate(terms.by).support_g, profile, terms);
}

}  // namespace packmerger
