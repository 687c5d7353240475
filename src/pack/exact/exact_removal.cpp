#include "pack/exact/exact_removal.h"

#include <algorithm>

#include "pack/exact/sweep.h"

namespace packmerger {

std::optional<Obstacle> first_obstacle(const std::vector<Mesh>& parts,
                                       const std::vector<int>& order,
                                       const std::vector<std::vector<Vec3>>& paths,
                                       const Progress& progress) {
  std::vector<Facing> tops;
  for (const Mesh& part : parts) tops.emplace_back(part, true);
  std::vector<MovableSurface> surfaces;
  if (std::any_of(paths.begin(), paths.end(), [](const auto& path) { return !path.empty(); }))
    for (const Mesh& part : parts) surfaces.emplace_back(part);
  for (std::size_t at = 0; at < order.size(); ++at) {
    const int taken = order[at];
    const std::vector<int> there(order.begin() + static_cast<std::ptrdiff_t>(at) + 1, order.end());
    Vec3 moved = Vec3::Zero();
    if (!surfaces.empty()) {
      const std::vector<Vec3>& path = paths[static_cast<std::size_t>(taken)];
      if (const auto other = met_on_path(surfaces, taken, there, path, progress))
        return Obstacle{taken, *other};
      for (const Vec3& step : path) moved += step;
    }
    const Facing bottom(parts[static_cast<std::size_t>(taken)], false);
    for (const int other : there)
      if (is_under(bottom, moved, tops[static_cast<std::size_t>(other)], progress))
        return Obstacle{taken, other};
  }
  return std::nullopt;
}

}  // namespace packmerger
