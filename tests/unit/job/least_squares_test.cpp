#include "job/calibrate/least_squares.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>

namespace packmerger {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

double any_number() { return *rc::gen::inRange(-1000, 1001) / 100.0; }

TEST(LeastSquares, NothingNearbyWithinTheLimitsIsBetter) {
  EXPECT_TRUE(rc::check([] {
    const int unknowns = *rc::gen::inRange(1, 5);
    const int rows = unknowns + *rc::gen::inRange(0, 5);
    MatrixXd a(rows, unknowns);
    VectorXd b(rows);
    for (int i = 0; i < rows; ++i) {
      b[i] = any_number();
      for (int j = 0; j < unknowns; ++j) a(i, j) = any_number();
    }
    RC_PRE(independence(a) > 1e-3);
    VectorXd low(unknowns);
    VectorXd high(unknowns);
    for (int j = 0; j < unknowns; ++j) {
      low[j] = any_number();
      high[j] = low[j] + *rc::gen::inRange(1, 500) / 100.0;
    }
    const BoundedSolution best = bounded_least_squares(a, b, low, high);
    RC_ASSERT(((best.values - low).array() >= 0).all() &&
              ((high - best.values).array() >= 0).all());
    // the problem is convex: where no step along the projected gradient helps, nothing does
    const VectorXd gradient = a.transpose() * (a * best.values - b);
    for (const double step : {1e-2, 1e-4, 1e-6}) {
      const VectorXd other = (best.values - step * gradient).cwiseMax(low).cwiseMin(high);
      RC_ASSERT((a * other - b).squaredNorm() >= best.squares - 1e-9 * (1 + best.squares));
    }
  }));
}

TEST(LeastSquares, Independence) {
  EXPECT_NEAR(independence(MatrixXd::Identity(3, 2) * 7), 1, 1e-12);
  MatrixXd same(2, 2);
  same << 1, 2, 3, 6;
  EXPECT_NEAR(independence(same), 0, 1e-12);
  EXPECT_EQ(independence(MatrixXd::Ones(1, 2)), 0);
  EXPECT_EQ(independence(MatrixXd::Zero(3, 1)), 0);
  EXPECT_EQ(independence(MatrixXd(2, 0)), 1);
}

}  // namespace
}  // namespace packmerger
