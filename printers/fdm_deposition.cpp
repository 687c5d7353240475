// FDM by deposition rate: material at a fixed rate, and a fixed time for each layer.
#include "printers/layers.h"
#include "printers/print_terms.h"
#include "printers/support_volume.h"
#include "printers/tray_estimate.h"

namespace packmerger {

TrayEstimate fdm_deposition_tray(const Profile& profile, const Tray& tray,
                                 const Progress& progress) {
  require_positive(profile, profile.fdm.deposition_cm3_h, "fdm.deposition_cm3_h");
  PrintTerms terms;
  terms.layers = layer_count(height_mm(tray), profile.layer_mm);
  terms.model_mm3 = matter_mm3(tray);
  terms.support_mm3 = support_volume_mm3(pointers(tray), radians(profile.support_angle_deg));
  progress.check();

  TrayEstimate result;
  result.model_mm3 = terms.model_mm3;
  result.model_g = model_g_of(profile, terms);
  result.support_mm3 = terms.support_mm3;
  result.support_g = support_g_of(profile, terms);
  result.time_s = deposition_s(profile.fdm, terms);
  return result;
}

}  // namespace packmerger
