#include "printers/polyjet.h"

#include <algorithm>
#include <cmath>

#include "printers/layer_extents.h"
#include "printers/support_volume.h"
#include "printers/tray_estimate.h"

namespace packmerger {
namespace {

constexpr double kRounding = 1e-6;  // of a swath

}  // namespace

double polyjet_passes(const PolyjetSettings& settings, double y_mm) {
  return std::max(1.0, std::ceil(y_mm / settings.swath_mm - kRounding));
}

double polyjet_layer_s(const PolyjetSettings& settings, double x_mm, double y_mm) {
  return settings.layer_s +
         polyjet_passes(settings, y_mm) * (settings.swath_s + settings.per_mm_x_s * x_mm);
}

TrayEstimate polyjet_tray(const Profile& profile, const Tray& tray, const Progress& progress) {
  const PolyjetSettings& settings = profile.polyjet;
  require_positive(profile, settings.swath_mm, "polyjet.swath_mm");
  const double angle = radians(profile.support_angle_deg);
  const std::vector<const Mesh*> parts = pointers(tray);

  TrayEstimate result;
  result.time_s = result.turned_time_s = settings.start_s;
  for (const auto& extent : layer_extents(parts, profile.layer_mm, angle)) {
    const Vec2 size = extent.isEmpty() ? Vec2(0, 0) : Vec2(extent.sizes());
    result.time_s += polyjet_layer_s(settings, size.x(), size.y());
    result.turned_time_s += polyjet_layer_s(settings, size.y(), size.x());
  }
  progress.check();
  result.support_mm3 = support_volume_mm3(parts, angle);
  result.support_g = result.support_mm3 / 1000 * settings.support_g_per_cm3;
  result.model_mm3 = matter_mm3(tray) * settings.model_waste_factor;
  result.model_g = result.model_mm3 / 1000 * profile.material.model_density_g_cm3;
  return result;
}

}  // namespace packmerger
