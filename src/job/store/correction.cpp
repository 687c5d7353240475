#include "job/store/correction.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace packmerger {
namespace {

constexpr double kNormalMad = 1.4826;  // a normal distribution's spread over its MAD
constexpr double kFurthest = 3.5;      // of the spread
constexpr double kLeastSpread = 0.05;  // that something is measured against
constexpr double kLeastScatter = 0.01;

double median(std::vector<double> values) {
  const std::size_t middle = values.size() / 2;
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(middle),
                   values.end());
  const double upper = values[middle];
  if (values.size() % 2 == 1) return upper;
  const double lower =
      *std::max_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(middle));
  return (lower + upper) / 2;
}

// The 97.5 % quantile of Student's t; beyond the table by Cornish and Fisher's expansion.
double student_t(int freedom) {
  constexpr std::array<double, 10> kTable = {12.706, 4.303, 3.182, 2.776, 2.571,
                                             2.447,  2.365, 2.306, 2.262, 2.228};
  if (freedom <= static_cast<int>(kTable.size()))
    return kTable.at(static_cast<std::size_t>(freedom) - 1);
  return 1.95996 + 2.3722 / freedom + 2.8225 / (freedom * static_cast<double>(freedom));
}

std::vector<double> ratio_logarithms(const std::vector<FinishedPrint>& prints) {
  std::vector<double> logarithms;
  for (const FinishedPrint& print : prints) {
    const double logarithm = std::log(print.printed_s / print.predicted_s);
    if (print.printed_s > 0 && print.predicted_s > 0 && std::isfinite(logarithm))
      logarithms.push_back(logarithm);
  }
  return logarithms;
}

std::vector<double> without_outliers(const std::vector<double>& values) {
  const double middle = median(values);
  std::vector<double> distances;
  for (const double value : values) distances.push_back(std::abs(value - middle));
  const double spread = std::max(kNormalMad * median(distances), kLeastSpread);
  std::vector<double> kept;
  for (const double value : values)
    if (std::abs(value - middle) <= kFurthest * spread) kept.push_back(value);
  return kept;
}

}  // namespace

std::optional<Correction> learn_correction(const std::vector<FinishedPrint>& prints) {
  const std::vector<double> all = ratio_logarithms(prints);
  if (all.size() < static_cast<std::size_t>(kLeastPrints)) return std::nullopt;
  const std::vector<double> kept = without_outliers(all);
  const auto count = static_cast<int>(kept.size());
  if (count < kLeastPrints) return std::nullopt;
  double mean = 0;
  for (const double value : kept) mean += value / count;
  double squares = 0;
  for (const double value : kept) squares += (value - mean) * (value - mean);
  const double scatter = std::max(std::sqrt(squares / (count - 1)), kLeastScatter);
  const double error = student_t(count - 1) * scatter / std::sqrt(count);
  Correction correction;
  correction.factor = std::exp(mean);
  correction.low = std::exp(mean - error);
  correction.high = std::exp(mean + error);
  correction.prints = count;
  correction.left_out = static_cast<int>(all.size()) - count;
  return correction;
}

}  // namespace packmerger
