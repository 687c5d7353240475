#include "model/profile/plate_keys.h"

#include <fmt/format.h>

namespace packmerger {
namespace {

constexpr std::size_t kMostAreas = 50;

bool is_beyond(const Vec2& corner, const Profile& profile) {
  constexpr double kRounding_mm = 1e-6;
  return corner.minCoeff() < -kRounding_mm ||
         (corner - profile.build().head<2>()).maxCoeff() > kRounding_mm;
}

}  // namespace

std::string wrong_with_plate(const Profile& profile) {
  if (!profile.plate_mm.empty()) {
    if (const std::string fault = fault_of(profile.plate_mm); !fault.empty())
      return "plate_mm must be a simple polygon: " + fault;
    for (std::size_t i = 0; i < profile.plate_mm.size(); ++i)
      if (is_beyond(profile.plate_mm[i], profile))
        return fmt::format(
            "plate_mm must lie within build_mm: corner {} is at {:g}, {:g}; corners are counted "
            "from its front left corner",
            i + 1, profile.plate_mm[i].x(), profile.plate_mm[i].y());
  }
  if (profile.keep_out_mm.size() > kMostAreas)
    return fmt::format("keep_out_mm must be {} areas at most", kMostAreas);
  const Eigen::AlignedBox2d tray(Vec2(0, 0), Vec2(profile.build_mm[0], profile.build_mm[1]));
  for (std::size_t i = 0; i < profile.keep_out_mm.size(); ++i) {
    const Polygon& area = profile.keep_out_mm[i];
    if (const std::string fault = fault_of(area); !fault.empty())
      return fmt::format("keep_out_mm must be simple polygons: of area {} {}", i + 1, fault);
    if (!bounding_box(area).intersects(tray))
      return fmt::format(
          "keep_out_mm must lie on the tray: area {} lies outside of build_mm, whose front left "
          "corner is 0, 0",
          i + 1);
  }
  return {};
}

}  // namespace packmerger
