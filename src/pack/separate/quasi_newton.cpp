#include "pack/separate/quasi_newton.h"

#include <vector>

namespace packmerger {
namespace {

constexpr std::size_t kMemory = 12;  // steps
constexpr double kLeastCurvature = 1e-12;

}  // namespace

Eigen::VectorXd QuasiNewton::direction(const Eigen::VectorXd& gradient, double first_step) const {
  Eigen::VectorXd result = gradient;
  std::vector<double> shares(pairs_.size());
  for (std::size_t k = pairs_.size(); k-- > 0;) {
    shares[k] = pairs_[k].step.dot(result) / pairs_[k].product;
    result -= shares[k] * pairs_[k].change;
  }
  if (pairs_.empty())
    result *= first_step;
  else
    result *= pairs_.back().product / pairs_.back().change.squaredNorm();
  for (std::size_t k = 0; k < pairs_.size(); ++k)
    result += pairs_[k].step * (shares[k] - pairs_[k].change.dot(result) / pairs_[k].product);
  return -result;
}

void QuasiNewton::learn(const Eigen::VectorXd& step, const Eigen::VectorXd& gradient_change) {
  const double product = step.dot(gradient_change);
  if (product <= kLeastCurvature) return;
  pairs_.push_back({step, gradient_change, product});
  if (pairs_.size() > kMemory) pairs_.pop_front();
}

}  // namespace packmerger
