// FDM by deposition rate: material at a fixed rate, and a fixed time for each layer.
#include "printers/layers.h"
#include "printers/support_volume.h"
#include "printers/tray_estimate.h"

namespace packmerger {

TrayEstimate fdm_deposition_tray(const Profile& profile, const Tray& tray,
                                 const Progress& progress) {
  const FdmSettings& settings = profile.fdm;
  require_positive(profile, settings.deposition_cm3_h, "fdm.deposition_cm3_h");

  TrayEstimate result;
  result.model_mm3 = matter_mm3(tray);
  result.model_g = result.model_mm3 / 1000 * profile.material.model_density_g_cm3;
  result.support_mm3 = support_volume_mm3(pointers(tray), radians(profile.support_angle_deg));
  progress.check();
  const double support_laid_mm3 = result.support_mm3 * settings.support_fill_fraction;
  result.support_g = support_laid_mm3 / 1000 * profile.material.support_density_g_cm3;
  result.time_s = settings.start_s +
                  (result.model_mm3 + support_laid_mm3) / 1000 / settings.deposition_cm3_h * 3600 +
                  layer_count(height_mm(tray), profile.layer_mm) * settings.layer_s;
  return result;
}

}  // namespace packmerger
