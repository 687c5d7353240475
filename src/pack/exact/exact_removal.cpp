#include "pack/exact/exact_removal.h"

namespace packmerger {
namespace {

constexpr double kInside_mm = 1e-6;  // rounding of what stands at the edge

}  // namespace

std::optional<Obstacle> first_obstacle(const StandingParts& parts, const std::vector<int>& order,
                                       const std::vector<std::vector<Vec3>>& paths) {
  for (std::size_t at = 0; at < order.size(); ++at) {
    const int taken = order[at];
    const std::vector<int> there(order.begin() + static_cast<std::ptrdiff_t>(at) + 1, order.end());
    Vec3 moved = Vec3::Zero();
    if (!paths.empty()) {
      const std::vector<Vec3>& path = paths[static_cast<std::size_t>(taken)];
      if (const auto other = parts.met_on_path(taken, there, path)) return Obstacle{taken, *other};
      for (const Vec3& step : path) moved += step;
    }
    for (const int other : there)
      if (parts.is_under(taken, moved, other)) return Obstacle{taken, other};
  }
  return std::nullopt;
}

std::optional<Obstacle> first_obstacle(const std::vector<Mesh>& parts,
                                       const std::vector<int>& order,
                                       const std::vector<std::vector<Vec3>>& paths,
                                       const Progress& progress) {
  return first_obstacle(StandingParts(parts, progress), order, paths);
}

bool is_over_base(const Box3& box, const Vec3& moved, const Vec2& base_mm) {
  const Box3 there = box.translated(moved);
  return there.min().minCoeff() >= -kInside_mm &&
         (base_mm - there.max().head<2>()).minCoeff() >= -kInside_mm;
}

bool stay_over_base(const StandingParts& parts, const std::vector<std::vector<Vec3>>& paths,
                    const Vec2& base_mm) {
  for (int part = 0; part < parts.size(); ++part) {
    Vec3 moved = Vec3::Zero();
    // A straight step stays where both its ends do.
    for (const Vec3& step : paths[static_cast<std::size_t>(part)])
      if (!is_over_base(parts.box(part), moved += step, base_mm)) return false;
  }
  return true;
}

}  // namespace packmerger
