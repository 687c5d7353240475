// One tray's figures by each of the analytic estimators, and what they share.
#pragma once

#include <vector>

#include "base/progress.h"
#include "model/printer.h"
#include "model/tray.h"

namespace packmerger {

struct TrayEstimate {
  double time_s = 0;
  double turned_time_s = 0;  // the tray turned by a quarter about the vertical
  double model_mm3 = 0;      // as deposited
  double model_g = 0;
  double support_mm3 = 0;  // V_s
  double support_g = 0;
};

TrayEstimate polyjet_tray(const Profile& profile, const Tray& tray, const Progress& progress);
TrayEstimate fdm_deposition_tray(const Profile& profile, const Tray& tray,
                                 const Progress& progress);
TrayEstimate fdm_toolpath_tray(const Profile& profile, const Tray& tray, const Progress& progress);

// The parts as slice_layers(), layer_extents() and support_measure() take them.
std::vector<const Mesh*> pointers(const Tray& tray);

// Sum of the parts' volumes and the height of the tallest.
double matter_mm3(const Tray& tray);
double height_mm(const Tray& tray);

// Throw Error{kBadProfile}: "Profile uprint: fdm.deposition_cm3_h must be positive …". The second
// asks for all that the tool path estimator divides by.
void require_positive(const Profile& profile, double value, const char* key);
void require_toolpath(const Profile& profile);

}  // namespace packmerger
