#include "job/calibrate/calibration_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include <Eigen/LU>

#include "job/calibrate/least_squares.h"

namespace packmerger {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Columns that leave less than this to tell them apart would make the error of a print twenty times
// as large.
constexpr double kIndependent = 0.05;

// constants = base + directions · parameters
struct Parameters {
  MatrixXd directions;
  VectorXd base;
  VectorXd low;
  VectorXd high;

  Index count() const { return directions.cols(); }
};

struct Equations {
  std::vector<FitUnknown> unknowns;
  MatrixXd slopes;  // rows × unknowns, over what was seen
  VectorXd seen;    // less the rest, over what was seen

  MatrixXd matrix(const Parameters& parameters) const { return slopes * parameters.directions; }
  VectorXd right_side(const Parameters& parameters) const {
    return seen - slopes * parameters.base;
  }
  BoundedSolution solve(const Parameters& parameters) const {
    return bounded_least_squares(matrix(parameters), right_side(parameters), parameters.low,
                                 parameters.high);
  }
};

Equations equations_of(const FitTask& task, const std::vector<FitRow>& rows) {
  Equations equations;
  equations.unknowns = task.main;
  equations.unknowns.insert(equations.unknowns.end(), task.extra.begin(), task.extra.end());
  const auto count = static_cast<Index>(rows.size());
  equations.slopes.resize(count, static_cast<Index>(equations.unknowns.size()));
  equations.seen.resize(count);
  for (Index i = 0; i < count; ++i) {
    const FitRow& row = rows[static_cast<std::size_t>(i)];
    equations.seen[i] = (row.seen - task.rest(row.terms)) / row.seen;
    for (Index j = 0; j < equations.slopes.cols(); ++j)
      equations.slopes(i, j) =
          equations.unknowns[static_cast<std::size_t>(j)].slope(row.terms) / row.seen;
  }
  return equations;
}

void add_parameter(Parameters& parameters, const VectorXd& direction, double low, double high) {
  const Index count = parameters.count();
  parameters.directions.conservativeResize(direction.size(), count + 1);
  parameters.directions.col(count) = direction;
  parameters.low.conservativeResize(count + 1);
  parameters.high.conservativeResize(count + 1);
  parameters.low[count] = low;
  parameters.high[count] = high;
}

// Every constant at the profile's value.
Parameters all_held(const Equations& equations) {
  const auto count = static_cast<Index>(equations.unknowns.size());
  Parameters parameters;
  parameters.directions.resize(count, 0);
  parameters.base.resize(count);
  for (Index j = 0; j < count; ++j)
    parameters.base[j] = equations.unknowns[static_cast<std::size_t>(j)].value;
  return parameters;
}

// Constant j gets a parameter of its own.
void free_one(Parameters& parameters, const Equations& equations, Index j) {
  for (Index k = 0; k < parameters.count(); ++k) parameters.directions(j, k) = 0;
  parameters.base[j] = 0;
  const FitUnknown& unknown = equations.unknowns[static_cast<std::size_t>(j)];
  add_parameter(parameters, VectorXd::Unit(parameters.base.size(), j), unknown.low, unknown.high);
}

Parameters main_apart(const Equations& equations, std::size_t main) {
  Parameters parameters = all_held(equations);
  for (std::size_t j = 0; j < main; ++j) free_one(parameters, equations, static_cast<Index>(j));
  return parameters;
}

Parameters one_factor(const Equations& equations) {
  Parameters parameters = all_held(equations);
  VectorXd direction = VectorXd::Zero(parameters.base.size());
  double low = 0;
  double high = std::numeric_limits<double>::max();
  for (Index j = 0; j < direction.size(); ++j) {
    const FitUnknown& unknown = equations.unknowns[static_cast<std::size_t>(j)];
    if (!unknown.scales || unknown.value <= 0) continue;
    direction[j] = unknown.value;
    parameters.base[j] = 0;
    low = std::max(low, unknown.low / unknown.value);
    high = std::min(high, unknown.high / unknown.value);
  }
  add_parameter(parameters, direction, low, high);
  return parameters;
}

// By the scatter of the relative errors; nothing where no row is left over.
std::optional<VectorXd> standard_errors(const Equations& equations, const Parameters& parameters,
                                        const BoundedSolution& solution) {
  std::vector<Index> open;
  for (Index k = 0; k < parameters.count(); ++k)
    if (!solution.at_limit[static_cast<std::size_t>(k)]) open.push_back(k);
  const Index left_over = equations.seen.size() - static_cast<Index>(open.size());
  if (left_over <= 0) return std::nullopt;
  VectorXd errors = VectorXd::Zero(parameters.base.size());
  if (open.empty()) return errors;
  const MatrixXd directions = parameters.directions(Eigen::all, open);
  const MatrixXd matrix = equations.slopes * directions;
  const MatrixXd covariance =
      (matrix.transpose() * matrix).inverse() * (solution.squares / static_cast<double>(left_over));
  for (Index j = 0; j < errors.size(); ++j)
    errors[j] = std::sqrt(
        std::max(0.0, (directions.row(j) * covariance * directions.row(j).transpose()).value()));
  return errors;
}

// The parameters that the rows can tell, and why others cannot be told.
struct Choice {
  Parameters parameters;
  std::vector<std::string> why;  // by unknown
};

// Adds the extra constants that prints are left over for.
Choice with_extras(Parameters parameters, const Equations& equations, std::size_t main) {
  Choice choice{std::move(parameters), std::vector<std::string>(equations.unknowns.size())};
  for (std::size_t j = main; j < equations.unknowns.size(); ++j) {
    const Index needed = choice.parameters.count() + 2;
    if (equations.seen.size() < needed) {
      choice.why[j] = fmt::format("held: needs {} prints or more", needed);
      continue;
    }
    Parameters more = choice.parameters;
    free_one(more, equations, static_cast<Index>(j));
    if (independence(equations.matrix(more)) < kIndependent)
      choice.why[j] = "held: these prints do not tell it from the other constants";
    else
      choice.parameters = more;
  }
  return choice;
}

Choice choose(const FitTask& task, const Equations& equations) {
  const std::size_t main = task.main.size();
  const Parameters apart = main_apart(equations, main);
  const Choice choice = with_extras(apart, equations, main);
  if (main == 1) return choice;
  std::string why;
  if (equations.seen.size() < apart.count()) {
    why = "one print fits one factor: the times of " + task.main_words + " keep their ratio";
  } else if (independence(equations.matrix(apart)) < kIndependent) {
    why = "these prints do not tell " + task.main_words + " apart: one factor, their ratio kept";
  } else {
    const std::vector<bool> at_limit = equations.solve(choice.parameters).at_limit;
    const auto end = at_limit.begin() + static_cast<std::ptrdiff_t>(main);
    if (std::find(at_limit.begin(), end, true) == end) return choice;
    why = "told apart, " + task.main_words + " would leave their range: one factor";
  }
  Choice tied = with_extras(one_factor(equations), equations, main);
  std::fill_n(tied.why.begin(), main, why);
  return tied;
}

}  // namespace

std::vector<FittedUnknown> fit_task(const FitTask& task, const std::vector<FitRow>& rows) {
  const Equations equations = equations_of(task, rows);
  std::vector<FittedUnknown> fitted(equations.unknowns.size());
  for (std::size_t j = 0; j < fitted.size(); ++j) fitted[j].value = equations.unknowns[j].value;
  if (rows.empty()) return fitted;
  const Choice choice = choose(task, equations);
  const BoundedSolution solution = equations.solve(choice.parameters);
  const VectorXd values = choice.parameters.base + choice.parameters.directions * solution.values;
  const auto errors = standard_errors(equations, choice.parameters, solution);
  for (std::size_t j = 0; j < fitted.size(); ++j) {
    const auto at = static_cast<Index>(j);
    FittedUnknown& one = fitted[j];
    one.why = choice.why[j];
    for (Index k = 0; k < choice.parameters.count(); ++k) {
      if (choice.parameters.directions(at, k) == 0) continue;
      one.fitted = true;
      one.at_limit = solution.at_limit[static_cast<std::size_t>(k)];
    }
    if (!one.fitted) continue;
    one.value = values[at];
    if (errors && !one.at_limit) one.standard_error = (*errors)[at];
  }
  return fitted;
}

}  // namespace packmerger
