#include "job/calibrate/least_squares.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <Eigen/QR>
#include <Eigen/SVD>

namespace packmerger {
namespace {

constexpr double kSlack = 1e-12;  // of a limit, for rounding

enum class Held { kFree, kLow, kHigh };

bool within(double value, double low, double high) {
  const double slack = kSlack * std::max({1.0, std::abs(low), std::abs(high)});
  return value >= low - slack && value <= high + slack;
}

// The unknowns that are held stand at their limits, the others are solved for; nothing where one of
// those leaves its limits.
std::optional<Eigen::VectorXd> solve(const Eigen::MatrixXd& a, const Eigen::VectorXd& b,
                                     const Eigen::VectorXd& low, const Eigen::VectorXd& high,
                                     const std::vector<Held>& held) {
  const Eigen::Index count = a.cols();
  Eigen::VectorXd values = Eigen::VectorXd::Zero(count);
  std::vector<Eigen::Index> open;
  for (Eigen::Index i = 0; i < count; ++i) {
    const Held how = held[static_cast<std::size_t>(i)];
    if (how == Held::kFree) open.push_back(i);
    if (how == Held::kLow) values[i] = low[i];
    if (how == Held::kHigh) values[i] = high[i];
  }
  if (open.empty()) return values;
  Eigen::MatrixXd columns(a.rows(), static_cast<Eigen::Index>(open.size()));
  Eigen::VectorXd lengths(columns.cols());
  for (Eigen::Index i = 0; i < columns.cols(); ++i) {
    const auto column = a.col(open[static_cast<std::size_t>(i)]);
    lengths[i] = std::max(column.norm(), std::numeric_limits<double>::min());
    columns.col(i) = column / lengths[i];
  }
  const Eigen::VectorXd solved = columns.colPivHouseholderQr().solve(b - a * values);
  for (Eigen::Index i = 0; i < columns.cols(); ++i) {
    const Eigen::Index at = open[static_cast<std::size_t>(i)];
    const double value = solved[i] / lengths[i];
    if (!within(value, low[at], high[at])) return std::nullopt;
    values[at] = std::clamp(value, low[at], high[at]);
  }
  return values;
}

// The next set of limits, counting in threes; false after the last.
bool advance(std::vector<Held>& held) {
  for (Held& one : held) {
    one = one == Held::kFree ? Held::kLow : one == Held::kLow ? Held::kHigh : Held::kFree;
    if (one != Held::kFree) return true;
  }
  return false;
}

}  // namespace

BoundedSolution bounded_least_squares(const Eigen::MatrixXd& a, const Eigen::VectorXd& b,
                                      const Eigen::VectorXd& low, const Eigen::VectorXd& high) {
  std::vector<Held> held(static_cast<std::size_t>(a.cols()), Held::kFree);
  BoundedSolution best;
  best.squares = std::numeric_limits<double>::infinity();
  do {
    const auto values = solve(a, b, low, high, held);
    if (!values) continue;
    const double squares = (a * *values - b).squaredNorm();
    if (squares >= best.squares) continue;
    best = {*values, {}, squares};
    for (const Held one : held) best.at_limit.push_back(one != Held::kFree);
  } while (advance(held));
  return best;
}

double independence(const Eigen::MatrixXd& a) {
  if (a.cols() == 0) return 1;
  if (a.rows() < a.cols()) return 0;
  Eigen::MatrixXd columns = a;
  for (Eigen::Index i = 0; i < columns.cols(); ++i) {
    const double length = columns.col(i).norm();
    if (!(length > 0)) return 0;
    columns.col(i) /= length;
  }
  return columns.jacobiSvd().singularValues().minCoeff();
}

}  // namespace packmerger
