#include "pack/maps/rotated_part.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "model/sentinel_heights.h"

namespace packmerger {
namespace {

constexpr float kSlack_units = 4e-3F;  // what single precision may lose of a height
constexpr double kRounding_units = 1e-6;

Height rounded_down(float units) { return static_cast<Height>(std::floor(units)); }
Height rounded_up(float units) { return static_cast<Height>(std::ceil(units)); }
Height rounded(float units) { return static_cast<Height>(std::lround(units)); }

HeightCell cell(int x, int y, Height value) {
  return {static_cast<std::int16_t>(x), static_cast<std::int16_t>(y), value};
}

// The lower side of the part grown by a ball of radius gap_mm, so that matter dropped on it keeps
// its distance in every direction: over a cell at horizontal distance d the part reaches
// sqrt(gap² - d²) further down. In units, kNothingAbove where empty.
std::vector<float> grown_low(const DepthMaps& maps, const Grid& grid, int growth, float lowest) {
  const int width = maps.width + 2 * growth;
  const int height = maps.height + 2 * growth;
  const float per_mm = static_cast<float>(1 / grid.unit_mm);
  std::vector<float> grown(static_cast<std::size_t>(width) * static_cast<std::size_t>(height),
                           kNothingAbove);
  for (int dy = -growth; dy <= growth; ++dy)
    for (int dx = -growth; dx <= growth; ++dx) {
      const double distance = std::hypot(apart_mm(dx, grid.cell_mm, grid.bounds),
                                         apart_mm(dy, grid.cell_mm, grid.bounds));
      if ((dx != 0 || dy != 0) && distance >= grid.gap_mm) continue;
      const float further =
          static_cast<float>(std::sqrt(grid.gap_mm * grid.gap_mm - distance * distance)) * per_mm;
      for (int row = 0; row < maps.height; ++row) {
        const float* from = &maps.low[static_cast<std::size_t>(row * maps.width)];
        float* to = &grown[static_cast<std::size_t>((row + dy + growth) * width + dx + growth)];
        for (int column = 0; column < maps.width; ++column)
          to[column] = std::min(to[column], (from[column] - lowest) * per_mm - further);
      }
    }
  return grown;
}

bool same_look(const RotatedPart& a, const RotatedPart& b) {
  constexpr double kRounding = 1e-9;  // sums in another order
  return a.rise == b.rise && a.hang_sum == b.hang_sum && a.box.min() == b.box.min() &&
         a.box.max() == b.box.max() &&
         std::abs(a.inside_support_mm3 - b.inside_support_mm3) <=
             kRounding * a.inside_support_mm3 &&
         a.reach == b.reach && a.top == b.top && a.roof == b.roof && a.hang == b.hang;
}

}  // namespace

std::vector<HeightCell> decisive_first(const std::vector<HeightCell>& cells) {
  constexpr int kTile = 4;
  std::map<std::pair<int, int>, std::size_t> lowest_of;  // tile → index
  const auto tile_of = [](int cell) { return (cell + 32768) / kTile; };
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const std::pair tile(tile_of(cells[i].y), tile_of(cells[i].x));
    const auto [entry, is_new] = lowest_of.try_emplace(tile, i);
    if (!is_new && cells[i].value < cells[entry->second].value) entry->second = i;
  }
  std::vector<bool> is_lowest(cells.size());
  for (const auto& [tile, index] : lowest_of) is_lowest[index] = true;
  std::vector<HeightCell> result;
  result.reserve(cells.size());
  for (std::size_t i = 0; i < cells.size(); ++i)
    if (is_lowest[i]) result.push_back(cells[i]);
  std::stable_sort(result.begin(), result.end(),
                   [](const HeightCell& a, const HeightCell& b) { return a.value < b.value; });
  for (std::size_t i = 0; i < cells.size(); ++i)
    if (!is_lowest[i]) result.push_back(cells[i]);
  return result;
}

RotatedPart quantised(const DepthMaps& maps, const Grid& grid) {
  RotatedPart part;
  const int growth = grid.growth();
  const Vec3 corner(maps.x0 * grid.cell_mm, maps.y0 * grid.cell_mm, maps.box.min().z());
  const Vec3 low = ((maps.box.min() - corner) / grid.unit_mm).array() + kRounding_units;
  const Vec3 high = ((maps.box.max() - corner) / grid.unit_mm).array() - kRounding_units;
  part.box = Box3(Vec3(low.array().floor().max(0) * grid.unit_mm),
                  Vec3(high.array().ceil() * grid.unit_mm));
  part.rise = static_cast<Height>(std::ceil(high.z()));

  const float lowest = static_cast<float>(maps.box.min().z());
  const float per_mm = static_cast<float>(1 / grid.unit_mm);
  const std::vector<float> grown = grown_low(maps, grid, growth, lowest);
  const float slack = grid.bounds ? kSlack_units : 0;
  const int grown_width = maps.width + 2 * growth;
  for (std::size_t at = 0; at < grown.size(); ++at)
    if (grown[at] != kNothingAbove)
      part.reach.push_back(cell(static_cast<int>(at) % grown_width - growth,
                                static_cast<int>(at) / grown_width - growth,
                                rounded_down(grown[at] - slack)));
  part.reach = decisive_first(part.reach);

  for (int y = 0; y < maps.height; ++y)
    for (int x = 0; x < maps.width; ++x) {
      const auto at = static_cast<std::size_t>(y * maps.width + x);
      if (maps.top[at] != kNothingBelow)
        part.top.push_back(cell(x, y, rounded_up((maps.top[at] - lowest) * per_mm + slack)));
      if (maps.roof[at] != kNothingBelow)
        part.roof.push_back(cell(x, y, rounded((maps.roof[at] - lowest) * per_mm)));
      if (maps.hangs[at] == 0) continue;
      part.hang.push_back(cell(x, y, rounded((maps.bottom[at] - lowest) * per_mm)));
      part.hang_sum += part.hang.back().value;
    }
  return part;
}

std::vector<const RotatedPart*> different(const std::vector<const RotatedPart*>& rotations) {
  std::vector<const RotatedPart*> kept;
  for (const RotatedPart* one : rotations)
    if (std::none_of(kept.begin(), kept.end(),
                     [one](const RotatedPart* other) { return same_look(*one, *other); }))
      kept.push_back(one);
  return kept;
}

}  // namespace packmerger
