// Search directions that learn the curvature from the last steps: limited-memory BFGS (Nocedal,
// 1980).
#pragma once

#include <deque>

#include <Eigen/Core>

namespace packmerger {

class QuasiNewton {
 public:
  // Downhill; along the gradient, shortened to first_step of it, while nothing is known.
  Eigen::VectorXd direction(const Eigen::VectorXd& gradient, double first_step) const;
  // What a step changed; ignored where it tells of no positive curvature.
  void learn(const Eigen::VectorXd& step, const Eigen::VectorXd& gradient_change);
  void forget() { pairs_.clear(); }
  bool knows_nothing() const { return pairs_.empty(); }

 private:
  struct Pair {
    Eigen::VectorXd step;
    Eigen::VectorXd change;
    double product = 0;  // of the two
  };
  std::deque<Pair> pairs_;  // the last at the end
};

}  // namespace packmerger
