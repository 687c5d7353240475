// What a print is to the estimators apart from their constants: figures of the trays alone, in
// which time and material are linear. So a print is measured once, however often constants are
// tried. docs/ESTIMATES.md has the formulas.
#pragma once

#include <vector>

#include "base/progress.h"
#include "model/printer.h"
#include "model/tray.h"

namespace packmerger {

// Sums over the trays.
struct PrintTerms {
  int trays = 1;
  double layers = 0;
  double passes = 0;       // PolyJet: swaths over all layers
  double passes_mm = 0;    // PolyJet: each as long as its layer in x
  double model_mm3 = 0;    // matter
  double support_mm3 = 0;  // V_s
  double other_s = 0;      // time beside: the slicer's, or that of the tool path without its start
};

// Which terms make a profile's time.
enum class TimeTerms {
  kLayersAndPasses,  // PolyJet
  kDeposition,       // FDM by deposition rate
  kOther             // sliced, or FDM by tool path: start_s for each tray and other_s
};
TimeTerms time_terms(const Profile& profile);

// Slices the trays where the profile is sliced. Throws what estimate() and slice() throw.
PrintTerms print_terms(const Profile& profile, const std::vector<Tray>& trays,
                       const Progress& progress);

// What estimate() gives for the same trays, to the rounding, or estimate_by_slicer()'s time.
// Masses are 0 for kOther: no constant of a profile makes them.
double time_of(const Profile& profile, const PrintTerms& terms);
// By deposition rate, also where the profile is sliced.
double deposition_s(const FdmSettings& fdm, const PrintTerms& terms);
double model_g_of(const Profile& profile, const PrintTerms& terms);
double support_g_of(const Profile& profile, const PrintTerms& terms);

}  // namespace packmerger
