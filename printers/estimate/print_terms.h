// What a print is to the estimators apart from their constants: figures of the trays alone, in
// which time and material are linear (printers/estimate/linear_estimate.h). So a print is measured
// once, however often constants are tried. docs/ESTIMATES.md has the formulas.
#pragma once

#include <vector>

#include "base/progress.h"
#include "model/packing.h"
#include "model/printer.h"
#include "model/tray.h"

namespace packmerger {

enum class Estimator {
  kPolyjet,
  kPowder,      // layers, and the bed of powder round the parts
  kDeposition,  // FDM by deposition rate
  kPath         // time is measured along a path: FDM by tool path, or the slicer's program
};
// The one that needs no slicer.
Estimator estimator_of(const Profile& profile);
// The one whose constants finished prints teach: kPath wherever the profile is sliced.
Estimator taught_estimator_of(const Profile& profile);

// Sums over the trays.
struct PrintTerms {
  Estimator by = Estimator::kPath;
  int trays = 1;
  double layers = 0;
  double passes = 0;       // kPolyjet: swaths over all layers
  double passes_mm = 0;    // kPolyjet: each as long as its layer in x
  double model_mm3 = 0;    // matter; kPath: the beads
  double support_mm3 = 0;  // V_s
  double held_mm3 = 0;     // V_s less what a tool path bridges
  double bed_mm3 = 0;      // kPowder: up to the highest part, parts included
  double path_s = 0;       // kPath: time without start_s

  PrintTerms& operator+=(const PrintTerms& other);  // of the same estimator
};

// As the trays stand, and turned by a quarter about the vertical: only kPolyjet tells them apart.
struct BothTerms {
  PrintTerms straight;
  PrintTerms turned;
};

// By estimator_of. Throws Error{kBadProfile} when a constant that the estimator divides by is not
// positive, Error{kInterrupted}.
BothTerms both_terms(const Profile& profile, const std::vector<Tray>& trays,
                     const Progress& progress);

// By taught_estimator_of: slices the trays where the profile is sliced, and knows no masses then.
// Throws what both_terms() and slice() throw.
PrintTerms print_terms(const Profile& profile, const std::vector<Tray>& trays,
                       const Progress& progress);

// Of a tray whose contents' figures alone are known, as the packer's search sees it.
// Every layer is taken to reach as far as the whole contents. Along a tool path the surface is not
// known here, so thin walls are assumed: solid, all beads at full speed. It is the same for every
// packing of the same parts, except where layers get too short.
PrintTerms predicted_terms(const Profile& profile, const TrayMeasure& tray);

// What both_terms() asks of the profile: "Profile uprint: fdm.deposition_cm3_h must be positive …".
void require_constants(const Profile& profile);

}  // namespace packmerger
