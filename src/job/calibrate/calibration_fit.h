// How one quantity of finished prints is fitted. For calibrate.cpp only.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "job/calibrate/calibrate.h"

namespace packmerger {

// A constant in the form in which the quantity is linear in it.
struct FitUnknown {
  std::string key;
  double value = 0;  // the profile's
  double low = 0;
  double high = 0;
  std::function<double(const PrintTerms&)> slope;  // of the quantity; not negative
  bool scales = true;                              // belongs to what one factor changes
};

// quantity = rest + Σ unknown · slope.
struct FitTask {
  std::vector<FitUnknown> main;   // told apart where the prints can, otherwise one factor
  std::vector<FitUnknown> extra;  // added one by one where a print is left over
  std::string main_words;         // "layers and passes"
  std::function<double(const PrintTerms&)> rest;
};

struct FitRow {
  PrintTerms terms;
  double seen = 0;
};

struct FittedUnknown {
  double value = 0;
  bool fitted = false;
  bool at_limit = false;
  std::optional<double> standard_error;
  std::string why;
};

// One for each of the task's unknowns, main before extra. All are held where there are no rows.
std::vector<FittedUnknown> fit_task(const FitTask& task, const std::vector<FitRow>& rows);

}  // namespace packmerger
