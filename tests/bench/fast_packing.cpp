#include "bench/fast_packing.h"

#include <cmath>
#include <limits>

namespace packmerger::bench {
namespace {

HeightCell cell(int x, int y, Height value) {
  return {static_cast<std::int16_t>(x), static_cast<std::int16_t>(y), value};
}

RotatedPart laid_out_one(const ReferenceMaps& maps, double unit_mm) {
  RotatedPart part;
  part.rotation = maps.rotation;
  part.box = Box3(Vec3(0, 0, 0), Vec3(maps.box.sizes()));
  part.rise = static_cast<Height>(std::ceil(maps.box.sizes().z() / unit_mm - 1e-6));
  const int grown_width = maps.width + 2 * maps.growth;
  for (std::size_t at = 0; at < maps.reach.size(); ++at)
    if (maps.reach[at] != ReferencePacker::kNothing)
      part.reach.push_back(cell(static_cast<int>(at) % grown_width - maps.growth,
                                static_cast<int>(at) / grown_width - maps.growth, maps.reach[at]));
  part.reach = decisive_first(part.reach);
  for (std::size_t at = 0; at < maps.top.size(); ++at) {
    if (maps.top[at] == ReferencePacker::kNothing) continue;
    const int x = static_cast<int>(at) % maps.width;
    const int y = static_cast<int>(at) / maps.width;
    part.top.push_back(cell(x, y, maps.top[at]));
    if (maps.hangs[at] == 0) continue;
    part.hang.push_back(cell(x, y, maps.bottom[at]));
    part.hang_sum += maps.bottom[at];
  }
  part.roof = part.top;
  return part;
}

}  // namespace

FastPacker::FastPacker(const PackProblem& problem, double unit_mm)
    : spec_{problem.build_mm, {problem.grid_mm, unit_mm, problem.gap_mm, false}, &problem.cost} {}

std::vector<RotatedPart> FastPacker::laid_out(const std::vector<ReferenceMaps>& maps) const {
  std::vector<RotatedPart> parts;
  for (const ReferenceMaps& one : maps) parts.push_back(laid_out_one(one, spec_.grid.unit_mm));
  return parts;
}

ReferencePacking FastPacker::pack(const std::vector<std::vector<RotatedPart>>& parts,
                                  const std::vector<double>& volumes_mm3,
                                  const Order& order) const {
  TrayState tray(spec_);
  ReferencePacking packing;
  for (const int index : order) {
    const double volume = volumes_mm3[static_cast<std::size_t>(index)];
    std::vector<const RotatedPart*> rotations;
    for (const RotatedPart& rotated : parts[static_cast<std::size_t>(index)])
      rotations.push_back(&rotated);
    const auto spot = best_spot(tray, rotations, volume, spec_);
    if (!spot) {
      packing.cost = std::numeric_limits<double>::infinity();
      return packing;
    }
    tray.put(*rotations[static_cast<std::size_t>(spot->rotation)], spot->x, spot->y, spot->z,
             spot->support_mm3, volume, spec_);
    packing.cost = spot->cost;
    packing.placed.push_back(
        {index, spot->rotation, spot->x, spot->y, spot->z, spot->top, 0, spot->cost});
  }
  return packing;
}

}  // namespace packmerger::bench
