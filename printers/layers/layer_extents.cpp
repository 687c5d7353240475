#include "printers/layers/layer_extents.h"

#include <algorithm>

#include "printers/layers/layers.h"
#include "printers/layers/support_volume.h"

namespace packmerger {
namespace {

constexpr int kExtentLines = 1 << 16;  // vertical lines for the extents of support

// An outline's box is that of the points where it crosses edges.
void extend_by_matter(const Mesh& part, double layer_mm, LayerExtents& extents) {
  const int count = static_cast<int>(extents.size());
  for (const std::array<int, 3>& triangle : part.triangles())
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3& low = part.points()[static_cast<std::size_t>(triangle[k])];
      const Vec3& high = part.points()[static_cast<std::size_t>(triangle[(k + 1) % 3])];
      if (!(low.z() < high.z())) continue;  // level, or the other triangle's way along this edge
      const LayerRange range = layers_between(low.z(), high.z(), layer_mm, count);
      const Vec2 step = (high - low).head<2>() / (high.z() - low.z());
      for (int layer = range.first; layer < range.end; ++layer) {
        const double above_mm = (layer + 0.5) * layer_mm - low.z();
        extents[layer].extend(Vec2(low.head<2>() + above_mm * step));
      }
    }
}

// How far the support reaches in x and y, in each layer.
void extend_by_support(const std::vector<const Mesh*>& parts, double layer_mm, double support_angle,
                       LayerExtents& extents) {
  const SupportGrid grid = support_grid(parts, kExtentLines);
  std::vector<std::vector<SupportSpan>> rows(grid.rows);
  for_each_support_row(parts, grid, support_angle,
                       [&](int row, const std::vector<SupportSpan>& spans) { rows[row] = spans; });
  const int count = static_cast<int>(extents.size());
  // Support in one column or row of cells, as a sum of steps up and down the layers: what it costs
  // does not depend on how long the spans are.
  const auto extend = [&](std::vector<int>& steps, const Vec2& low, const Vec2& high, int axis) {
    int open = 0;
    for (int layer = 0; layer < count; ++layer) {
      open += steps[layer];
      if (open == 0) continue;
      Eigen::AlignedBox2d& extent = extents[layer];
      extent.min()[axis] = std::min(extent.min()[axis], low[axis]);
      extent.max()[axis] = std::max(extent.max()[axis], high[axis]);
    }
    std::fill(steps.begin(), steps.end(), 0);
  };
  const auto add = [&](std::vector<int>& steps, const SupportSpan& span) {
    const LayerRange range = layers_between(span.low_mm, span.high_mm, layer_mm, count);
    ++steps[range.first];
    --steps[range.end];
  };
  std::vector<int> steps(count + 1, 0);
  for (int row = 0; row < grid.rows; ++row) {
    for (const SupportSpan& span : rows[row]) add(steps, span);
    const Vec2 low = grid.low + Vec2(0, row * grid.cell_mm.y());
    extend(steps, low, low + grid.cell_mm, 1);
  }
  std::vector<std::vector<SupportSpan>> columns(grid.columns);
  for (const std::vector<SupportSpan>& row : rows)
    for (const SupportSpan& span : row) columns[span.column].push_back(span);
  for (int column = 0; column < grid.columns; ++column) {
    for (const SupportSpan& span : columns[column]) add(steps, span);
    const Vec2 low = grid.low + Vec2(column * grid.cell_mm.x(), 0);
    extend(steps, low, low + grid.cell_mm, 0);
  }
}

}  // namespace

LayerExtents layer_extents(const std::vector<const Mesh*>& parts, double layer_mm,
                           double support_angle) {
  LayerExtents extents(layer_count(top_of(parts), layer_mm));
  for (const Mesh* part : parts) extend_by_matter(*part, layer_mm, extents);
  extend_by_support(parts, layer_mm, support_angle, extents);
  return extents;
}

}  // namespace packmerger
