#include "printers/estimate/polyjet.h"

#include <algorithm>
#include <cmath>

#include "printers/layers/layer_extents.h"

namespace packmerger {
namespace {

constexpr double kRounding = 1e-6;  // of a swath

}  // namespace

void add_passes(PrintTerms& terms, const PolyjetSettings& settings, double layers, double x_mm,
                double y_mm) {
  const double swaths = std::max(1.0, std::ceil(y_mm / settings.swath_mm - kRounding));
  terms.passes += layers * swaths;
  terms.passes_mm += layers * swaths * x_mm;
}

void add_passes(BothTerms& both, const Profile& profile, const std::vector<const Mesh*>& parts) {
  const double angle = radians(profile.support_angle_deg);
  for (const auto& extent : layer_extents(parts, profile.layer_mm, angle)) {
    const Vec2 size = extent.isEmpty() ? Vec2(0, 0) : Vec2(extent.sizes());
    add_passes(both.straight, profile.polyjet, 1, size.x(), size.y());
    add_passes(both.turned, profile.polyjet, 1, size.y(), size.x());
  }
}

}  // namespace packmerger
