#include "job/calibrate/calibrate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <stdexcept>

#include "base/error.h"
#include "job/calibrate/calibration_fit.h"
#include "model/profile/profile_keys.h"
#include "printers/estimate/linear_estimate.h"

namespace packmerger {
namespace {

constexpr double kLeastLayer_s = 0.001;  // a PolyJet profile without is refused
constexpr double kLeastRate_cm3_h = 0.1;
constexpr std::size_t kLeastToLeaveOut = 3;
constexpr double kSuspicious = 5;  // times as much as predicted, or as little

using Seen = std::optional<double> CalibrationPrint::*;
using Predict = double (*)(const Profile&, const PrintTerms&);

struct Quantity {
  const char* name;   // for programs
  const char* words;  // for people
  const char* unit;
  Seen seen;
  Predict predict;
};

constexpr Quantity kTime{"time", "time", "s", &CalibrationPrint::time_s, time_of};
constexpr Quantity kModel{"model", "model material", "g", &CalibrationPrint::model_g, model_g_of};
constexpr Quantity kSupport{"support", "support material", "g", &CalibrationPrint::support_g,
                            support_g_of};

struct BoundKey {
  double* value = nullptr;
  Limits limits;
  std::string unit;
};

BoundKey bound_key(Profile& profile, std::string_view name) {
  for (const Key& key : keys_of(profile))
    if (key.name == name) {
      const auto& number = std::get<NumberKey>(key.kind);
      return {number.value, number.limits, key.unit};
    }
  throw std::logic_error("no key " + std::string(name));
}

// Rates are fitted as seconds for each cm³, in which time is linear.
constexpr std::string_view kRate = "fdm.deposition_cm3_h";
double rate_from(double s_per_cm3) { return 3600 / s_per_cm3; }

FitUnknown unknown(const Profile& profile, const LinearTerm& term) {
  Profile copy = profile;
  const Limits limits = bound_key(copy, term.key).limits;
  FitUnknown unknown{
      std::string(term.key), term.constant(profile), limits.least, limits.most,
      [term, profile](const PrintTerms& terms) { return term.amount(profile, terms); }};
  if (term.key == kRate) {
    unknown.low = 3600 / limits.most;
    unknown.high = 3600 / kLeastRate_cm3_h;
  }
  if (term.key == "polyjet.layer_s" || term.key == "powder.layer_s") unknown.low = kLeastLayer_s;
  unknown.scales = !term.key.ends_with(".start_s");
  return unknown;
}

// The constants that even few prints tell; all others wait for more.
struct MainConstants {
  std::vector<std::string_view> keys;
  const char* words;
};

MainConstants main_constants(Estimator estimator) {
  switch (estimator) {
    case Estimator::kPolyjet:
      return {{"polyjet.layer_s", "polyjet.swath_s"}, "layers and passes"};
    case Estimator::kPowder:
      return {{"powder.layer_s"}, "layers"};
    case Estimator::kDeposition:
      return {{kRate, "fdm.layer_s"}, "deposition and layers"};
    case Estimator::kPath:
      break;
  }
  return {{"fdm.start_s"}, ""};
}

FitTask time_task(const Profile& profile) {
  const Estimator estimator = taught_estimator_of(profile);
  const MainConstants main = main_constants(estimator);
  FitTask task;
  task.main_words = main.words;
  task.rest = [](const PrintTerms& terms) { return terms.path_s; };
  for (const LinearTerm& term : linear_estimate(estimator).time_s) {
    if (term.key.empty()) continue;
    const bool is_main = std::find(main.keys.begin(), main.keys.end(), term.key) != main.keys.end();
    (is_main ? task.main : task.extra).push_back(unknown(profile, term));
  }
  return task;
}

FitTask material_task(const Profile& profile, const LinearTerm& term, double g_each) {
  FitTask task;
  task.rest = [](const PrintTerms&) { return 0.0; };
  task.main = {unknown(profile, term)};
  task.main.front().slope = [term, profile, g_each](const PrintTerms& terms) {
    return g_each * term.amount(profile, terms);
  };
  return task;
}

double six_digits(double value) {
  return std::strtod(fmt::format("{:.6g}", value).c_str(), nullptr);
}

void take_over(Profile& profile, const FitTask& task, const std::vector<FittedUnknown>& fitted,
               int prints, const Quantity& quantity, std::vector<CalibratedConstant>& constants) {
  std::vector<FitUnknown> unknowns = task.main;
  unknowns.insert(unknowns.end(), task.extra.begin(), task.extra.end());
  for (std::size_t j = 0; j < unknowns.size(); ++j) {
    const BoundKey key = bound_key(profile, unknowns[j].key);
    const FittedUnknown& one = fitted[j];
    CalibratedConstant told{unknowns[j].key, key.unit, *key.value,         *key.value, one.fitted,
                            one.at_limit,    prints,   one.standard_error, one.why};
    if (prints == 0) told.why = fmt::format("held: no print tells its {}", quantity.words);
    if (one.fitted) {
      const bool is_rate = unknowns[j].key == kRate;
      const double value = is_rate ? rate_from(one.value) : one.value;
      told.after = std::clamp(six_digits(value), key.limits.least, key.limits.most);
      if (is_rate && one.standard_error)
        told.standard_error = value * value / 3600 * *one.standard_error;
      *key.value = told.after;
    }
    constants.push_back(std::move(told));
  }
}

// Where a constant of the profile tells it.
bool teaches_support(Estimator estimator) {
  return estimator != Estimator::kPath && !linear_estimate(estimator).support_g.front().key.empty();
}

class Fit {
 public:
  Fit(const Profile& profile, const std::vector<CalibrationPrint>& prints) : prints_(prints) {
    result_.profile = profile;
    const Estimator estimator = taught_estimator_of(profile);
    const LinearEstimate& linear = linear_estimate(estimator);
    if (estimator == Estimator::kPolyjet)
      fit(kModel, material_task(profile, linear.model_mm3.front(),
                                profile.material.model_density_g_cm3 / 1000));
    else
      refuse_material(kModel);
    if (teaches_support(estimator))
      fit(kSupport, material_task(profile, linear.support_g.front(), 1));
    else
      refuse_material(kSupport);
    fit(kTime, time_task(result_.profile));  // which heeds the support that was fitted
  }

  Calibration result() && { return std::move(result_); }

 private:
  void fit(const Quantity& quantity, const FitTask& task) {
    std::vector<FitRow> rows;
    for (const CalibrationPrint& print : prints_) {
      const std::optional<double>& seen = print.*quantity.seen;
      if (!seen) continue;
      if (quantity.predict(result_.profile, print.terms) > 0)
        rows.push_back({print.terms, *seen});
      else
        warn("nothing_predicted",
             fmt::format("{}: no {} is predicted for it at all, so it teaches nothing of that",
                         print.name, quantity.words));
    }
    take_over(result_.profile, task, fit_task(task, rows), static_cast<int>(rows.size()), quantity,
              result_.constants);
  }

  void refuse_material(const Quantity& quantity) {
    const bool told = std::any_of(prints_.begin(), prints_.end(), [&](const auto& print) {
      return (print.*quantity.seen).has_value();
    });
    if (!told) return;
    const char* from = result_.profile.is_sliced() ? "the slicer" : "volume and density";
    warn("no_such_constant",
         fmt::format("what is told of {} is not used: {} alone tell it here, no constant "
                     "of the profile",
                     quantity.words, from));
  }

  void warn(const char* code, const std::string& text) { result_.warnings.push_back({code, text}); }

  const std::vector<CalibrationPrint>& prints_;
  Calibration result_;
};

bool anything_fitted(const Calibration& calibration) {
  return std::any_of(calibration.constants.begin(), calibration.constants.end(),
                     [](const CalibratedConstant& constant) { return constant.fitted; });
}

double root_mean_square(const std::vector<double>& values) {
  double squares = 0;
  for (const double value : values) squares += value * value;
  return values.empty() ? 0 : std::sqrt(squares / static_cast<double>(values.size()));
}

// What each print would be predicted by a fit to all the others.
std::vector<std::optional<double>> left_out(const Profile& profile, const Quantity& quantity,
                                            const std::vector<CalibrationPrint>& prints) {
  std::vector<std::optional<double>> predicted(prints.size());
  const auto count = std::count_if(prints.begin(), prints.end(), [&](const auto& print) {
    return (print.*quantity.seen).has_value();
  });
  if (static_cast<std::size_t>(count) < kLeastToLeaveOut) return predicted;
  for (std::size_t i = 0; i < prints.size(); ++i) {
    if (!(prints[i].*quantity.seen)) continue;
    std::vector<CalibrationPrint> others = prints;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
    predicted[i] = quantity.predict(Fit(profile, others).result().profile, prints[i].terms);
  }
  return predicted;
}

void judge(Calibration& calibration, const Profile& before, const Quantity& quantity,
           const std::vector<CalibrationPrint>& prints) {
  QuantityFit fit{quantity.name, quantity.unit, {}, 0, 0, {}};
  const auto others = left_out(before, quantity, prints);
  std::vector<double> was;
  std::vector<double> is;
  std::vector<double> would_be;
  for (std::size_t i = 0; i < prints.size(); ++i) {
    const std::optional<double>& seen = prints[i].*quantity.seen;
    if (!seen) continue;
    const PrintMisfit misfit{prints[i].name, *seen, quantity.predict(before, prints[i].terms),
                             quantity.predict(calibration.profile, prints[i].terms), others[i]};
    if (!(misfit.before > 0)) continue;  // warned of already
    was.push_back(misfit.before / *seen - 1);
    is.push_back(misfit.after / *seen - 1);
    if (misfit.left_out) would_be.push_back(*misfit.left_out / *seen - 1);
    const double ratio = *seen / misfit.before;
    if (ratio > kSuspicious || ratio < 1 / kSuspicious)
      calibration.warnings.push_back(
          {"far_off", fmt::format("{}: its {} is {:.3g} times what the profile predicts; check its "
                                  "size and what was typed",
                                  misfit.print, quantity.words, ratio)});
    fit.prints.push_back(misfit);
  }
  if (fit.prints.empty()) return;
  fit.rms_before = root_mean_square(was);
  fit.rms_after = root_mean_square(is);
  if (!would_be.empty()) fit.rms_left_out = root_mean_square(would_be);
  calibration.quantities.push_back(std::move(fit));
}

void warn_of_exact_fits(Calibration& calibration) {
  for (const CalibratedConstant& constant : calibration.constants) {
    if (!constant.fitted || constant.at_limit || constant.standard_error) continue;
    calibration.warnings.push_back(
        {"no_print_left",
         fmt::format("{} is fitted by as few prints as there are constants: nothing is left to "
                     "judge it by, and a further print would tell its error",
                     constant.key)});
    return;
  }
}

}  // namespace

Calibration calibrate(const Profile& profile, const std::vector<CalibrationPrint>& prints) {
  Calibration calibration = Fit(profile, prints).result();
  if (!anything_fitted(calibration))
    throw Error(Fault::kBadInput,
                fmt::format("These {} prints tell nothing that a constant of {} could be fitted to",
                            prints.size(), profile.id),
                "Tell how long each took (--took 6h23m), or how much support it used.");
  judge(calibration, profile, kTime, prints);
  const Estimator estimator = taught_estimator_of(profile);
  if (estimator == Estimator::kPolyjet) judge(calibration, profile, kModel, prints);
  if (teaches_support(estimator)) judge(calibration, profile, kSupport, prints);
  warn_of_exact_fits(calibration);
  return calibration;
}

}  // namespace packmerger
