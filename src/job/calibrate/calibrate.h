// Fits the constants of a profile's estimator to finished prints: least squares of the relative
// errors, each constant within the range its key has. docs/ESTIMATES.md, "Calibrate to your
// machine".
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "model/printer.h"
#include "model/warning.h"
#include "printers/estimate/print_terms.h"

namespace packmerger {

// One finished print. What was not seen teaches nothing; what was is positive and finite.
struct CalibrationPrint {
  std::string name;
  PrintTerms terms;              // by the profile that is calibrated
  std::optional<double> time_s;  // all its trays, pauses left out
  std::optional<double> model_g;
  std::optional<double> support_g;
};

struct CalibratedConstant {
  std::string key;  // "polyjet.layer_s"
  std::string unit;
  double before = 0;
  double after = 0;  // rounded to six digits; before, where it was held
  bool fitted = false;
  bool at_limit = false;                 // of its range: the prints ask for more
  int prints = 0;                        // that it was fitted to
  std::optional<double> standard_error;  // nothing where no print is left over to judge by
  std::string why;  // why it was held, or what it was fitted with; may be empty
};

// One print as it was and as it is predicted.
struct PrintMisfit {
  std::string print;
  double seen = 0;
  double before = 0;               // by the profile as it was
  double after = 0;                // by the fit
  std::optional<double> left_out;  // by a fit to all other prints; where there are three or more
};

struct QuantityFit {
  std::string quantity;  // "time", "model", "support"
  std::string unit;      // "s", "g"
  std::vector<PrintMisfit> prints;
  // Root mean squares of predicted / seen - 1.
  double rms_before = 0;
  double rms_after = 0;
  std::optional<double> rms_left_out;
};

struct Calibration {
  Profile profile;  // with the fitted constants
  std::vector<CalibratedConstant> constants;
  std::vector<QuantityFit> quantities;  // those that some print tells
  Warnings warnings;
};

// Which constants: those that these prints can tell apart (the least singular value of their
// columns, each of length one, is 0.05 or more); times of layers and passes, or of layers and
// deposition, that they cannot keep their ratio and are fitted by one factor, as with a single
// print. start_s and per_mm_x_s are fitted where a print is left over. All others are held.
// Throws Error{kBadInput} when no constant can be fitted.
Calibration calibrate(const Profile& profile, const std::vector<CalibrationPrint>& prints);

}  // namespace packmerger
