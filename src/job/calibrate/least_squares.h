// Small linear least squares with limits.
#pragma once

#include <vector>

#include <Eigen/Core>

namespace packmerger {

struct BoundedSolution {
  Eigen::VectorXd values;
  std::vector<bool> at_limit;  // held by one of its limits
  double squares = 0;          // the sum of the squared residuals
};

// The x with low ≤ x ≤ high for which |A x − b|² is least, exactly: every set of limits that may
// hold is tried, 3^n of them. Columns of A are the unknowns, at most 6, and must be independent.
BoundedSolution bounded_least_squares(const Eigen::MatrixXd& a, const Eigen::VectorXd& b,
                                      const Eigen::VectorXd& low, const Eigen::VectorXd& high);

// How well the columns can be told apart: the least singular value once each has length one; 1
// where they are orthogonal, 0 where one is made of the others, vanishes, or rows are too few. 1
// for no columns.
double independence(const Eigen::MatrixXd& a);

}  // namespace packmerger
