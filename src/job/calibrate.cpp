#include "job/calibrate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <stdexcept>

#include "base/error.h"
#include "job/calibration_fit.h"
#include "model/profile_keys.h"

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

BoundKey bound_key(Profile& profile, const std::string& name) {
  for (const Key& key : keys_of(profile))
    if (key.name == name) {
      const auto& number = std::get<NumberKey>(key.kind);
      return {number.value, number.limits, key.unit};
    }
  throw std::logic_error("no key " + name);
}

FitUnknown unknown(const Profile& profile, const std::string& key,
                   std::function<double(const PrintTerms&)> slope, bool scales = true) {
  Profile copy = profile;
  const BoundKey bound = bound_key(copy, key);
  return {key, *bound.value, bound.limits.least, bound.limits.most, std::move(slope), scales};
}

// Rates are fitted as seconds for each cm³, in which time is linear.
const std::string kRate = "fdm.deposition_cm3_h";
double rate_from(double s_per_cm3) { return 3600 / s_per_cm3; }

FitUnknown seconds_per_cm3(const Profile& profile) {
  const double fill = profile.fdm.support_fill_fraction;
  FitUnknown rate = unknown(profile, kRate, [fill](const PrintTerms& terms) {
    return (terms.model_mm3 + fill * terms.support_mm3) / 1000;
  });
  rate.value = 3600 / rate.value;
  rate.low = 3600 / rate.high;
  rate.high = 3600 / kLeastRate_cm3_h;
  return rate;
}

FitUnknown start_of(const Profile& profile, const std::string& key) {
  return unknown(
      profile, key, [](const PrintTerms& terms) { return terms.trays; }, false);
}

FitTask time_task(const Profile& profile) {
  FitTask task;
  task.rest = [](const PrintTerms& terms) { return terms.other_s; };
  const auto layers = [](const PrintTerms& terms) { return terms.layers; };
  switch (time_terms(profile)) {
    case TimeTerms::kLayersAndPasses: {
      FitUnknown layer = unknown(profile, "polyjet.layer_s", layers);
      layer.low = kLeastLayer_s;
      task.main = {layer, unknown(profile, "polyjet.swath_s",
                                  [](const PrintTerms& terms) { return terms.passes; })};
      task.main_words = "layers and passes";
      task.extra = {start_of(profile, "polyjet.start_s"),
                    unknown(profile, "polyjet.per_mm_x_s",
                            [](const PrintTerms& terms) { return terms.passes_mm; })};
      break;
    }
    case TimeTerms::kDeposition:
      task.main = {seconds_per_cm3(profile), unknown(profile, "fdm.layer_s", layers)};
      task.main_words = "deposition and layers";
      task.extra = {start_of(profile, "fdm.start_s")};
      break;
    case TimeTerms::kOther:
      task.main = {start_of(profile, "fdm.start_s")};
      break;
  }
  return task;
}

FitTask material_task(const Profile& profile, const std::string& key, Predict predict) {
  FitTask task;
  task.rest = [](const PrintTerms&) { return 0.0; };
  Profile copy = profile;
  *bound_key(copy, key).value = 1;
  task.main = {unknown(profile, key,
                       [copy, predict](const PrintTerms& terms) { return predict(copy, terms); })};
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

class Fit {
 public:
  Fit(const Profile& profile, const std::vector<CalibrationPrint>& prints) : prints_(prints) {
    result_.profile = profile;
    if (time_terms(profile) == TimeTerms::kLayersAndPasses) {
      fit_material(kModel, "polyjet.model_waste_factor");
      fit_material(kSupport, "polyjet.support_g_per_cm3");
    } else if (time_terms(profile) == TimeTerms::kDeposition) {
      fit_material(kSupport, "fdm.support_fill_fraction");
      refuse_material(kModel);
    } else {
      refuse_material(kModel);
      refuse_material(kSupport);
    }
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

  void fit_material(const Quantity& quantity, const std::string& key) {
    fit(quantity, material_task(result_.profile, key, quantity.predict));
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
  const bool has_model = time_terms(profile) == TimeTerms::kLayersAndPasses;
  const bool has_support = time_terms(profile) != TimeTerms::kOther;
  if (has_model) judge(calibration, profile, kModel, prints);
  if (has_support) judge(calibration, profile, kSupport, prints);
  warn_of_exact_fits(calibration);
  return calibration;
}

}  // namespace packmerger
