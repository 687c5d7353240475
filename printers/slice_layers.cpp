#include "printers/slice_layers.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "printers/support_volume.h"

namespace packmerger {
namespace {

constexpr int kExtentLines = 1 << 16;  // vertical lines for the extents of support
constexpr double kRounding = 1e-6;     // of a layer

// The layers whose middle plane lies in (low, high], as [first, end). A corner in the plane itself
// counts as above it, everywhere, so that contours close.
struct LayerRange {
  int first = 0;
  int end = 0;
};

LayerRange layers_between(double low_mm, double high_mm, double layer_mm, int count) {
  const auto planes_at_or_below = [&](double z_mm) {
    return std::clamp(static_cast<int>(std::floor(z_mm / layer_mm - 0.5)) + 1, 0, count);
  };
  return {planes_at_or_below(low_mm), planes_at_or_below(high_mm)};
}

// Cuts one part at one height. `facets` holds, sorted, at least every facet the plane meets.
class Cut {
 public:
  Cut(const Mesh& part, double z_mm, const std::vector<int>& facets, Layer& layer)
      : part_(part), z_mm_(z_mm), facets_(facets), layer_(layer), seen_(facets.size(), false) {}

  void run() {
    for (std::size_t i = 0; i < facets_.size(); ++i)
      if (!seen_[i]) trace(Mesh::FaceHandle(facets_[i]));
  }

 private:
  bool above(Mesh::VertexHandle vertex) const { return part_.point(vertex).z() >= z_mm_; }

  // The facet's half-edge along which the outline, matter on its left, leaves it: the one that goes
  // up through the plane. Invalid where the plane misses the facet.
  Mesh::HalfedgeHandle exit_of(Mesh::FaceHandle facet) const {
    for (const auto edge : part_.fh_range(facet))
      if (!above(part_.from_vertex_handle(edge)) && above(part_.to_vertex_handle(edge)))
        return edge;
    return Mesh::HalfedgeHandle();
  }

  Vec2 point_on(Mesh::HalfedgeHandle edge) const {
    const Vec3& low = part_.point(part_.from_vertex_handle(edge));
    const Vec3& high = part_.point(part_.to_vertex_handle(edge));
    return (low + (high - low) * ((z_mm_ - low.z()) / (high.z() - low.z()))).head<2>();
  }

  void mark(Mesh::FaceHandle facet) {
    seen_[std::lower_bound(facets_.begin(), facets_.end(), facet.idx()) - facets_.begin()] = true;
  }

  // Follows one contour from facet to facet until it is closed.
  void trace(Mesh::FaceHandle start) {
    Mesh::HalfedgeHandle edge = exit_of(start);
    if (!edge.is_valid()) return;
    Contour contour;
    const Vec2 origin = point_on(edge);  // near the contour, for precision
    Vec2 previous = origin;
    double twice_area = 0;
    for (Mesh::FaceHandle facet = start;;) {
      mark(facet);
      contour.box.extend(previous);
      facet = part_.opposite_face_handle(edge);
      edge = exit_of(facet);
      const Vec2 next = point_on(edge);
      contour.perimeter_mm += (next - previous).norm();
      const Vec2 a = previous - origin;
      const Vec2 b = next - origin;
      twice_area += a.x() * b.y() - a.y() * b.x();
      previous = next;
      if (facet == start) break;
    }
    contour.area_mm2 = twice_area / 2;
    layer_.extent.extend(contour.box);
    layer_.contours.push_back(contour);
  }

  const Mesh& part_;
  double z_mm_;
  const std::vector<int>& facets_;
  Layer& layer_;
  std::vector<bool> seen_;
};

// For each layer the facets it meets, sorted.
std::vector<std::vector<int>> facets_by_layer(const Mesh& part, double layer_mm, int count) {
  std::vector<std::vector<int>> facets(count);
  for (const auto face : part.faces()) {
    const auto [a, b, c] = corners(part, face);
    const auto [low, high] = std::minmax({a.z(), b.z(), c.z()});
    // one layer more on either side: rounding decides nothing here, Cut does
    const LayerRange range = layers_between(low, high, layer_mm, count);
    for (int layer = std::max(0, range.first - 1); layer < std::min(count, range.end + 1); ++layer)
      facets[layer].push_back(face.idx());
  }
  return facets;
}

// How far the support reaches in x and y, in each layer.
void extend_by_support(const std::vector<const Mesh*>& parts, double layer_mm, double support_angle,
                       std::vector<Layer>& layers) {
  const SupportGrid grid = support_grid(parts, kExtentLines);
  std::vector<std::vector<SupportSpan>> rows(grid.rows);
  for_each_support_row(parts, grid, support_angle,
                       [&](int row, const std::vector<SupportSpan>& spans) { rows[row] = spans; });
  const int count = static_cast<int>(layers.size());
  // Support in one column or row of cells, as a sum of steps up and down the layers: what it costs
  // does not depend on how long the spans are.
  const auto extend = [&](std::vector<int>& steps, const Vec2& low, const Vec2& high, int axis) {
    int open = 0;
    for (int layer = 0; layer < count; ++layer) {
      open += steps[layer];
      if (open == 0) continue;
      Eigen::AlignedBox2d& extent = layers[layer].extent;
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

int layer_count(double height_mm, double layer_mm) {
  return std::max(0, static_cast<int>(std::ceil(height_mm / layer_mm - kRounding)));
}

std::vector<Layer> slice_layers(const std::vector<const Mesh*>& parts, double layer_mm,
                                double support_angle) {
  double top_mm = 0;
  for (const Mesh* part : parts)
    if (part->n_vertices() > 0) top_mm = std::max(top_mm, bounding_box(*part).max().z());
  const int count = layer_count(top_mm, layer_mm);
  std::vector<Layer> layers(count);
  for (const Mesh* part : parts) {
    const std::vector<std::vector<int>> facets = facets_by_layer(*part, layer_mm, count);
    parallel_for(static_cast<std::size_t>(count), [&](std::size_t layer) {
      const double z_mm = (static_cast<double>(layer) + 0.5) * layer_mm;
      Cut(*part, z_mm, facets[layer], layers[layer]).run();
    });
  }
  for (Layer& layer : layers) {
    for (const Contour& contour : layer.contours) {
      layer.area_mm2 += contour.area_mm2;
      layer.perimeter_mm += contour.perimeter_mm;
    }
  }
  extend_by_support(parts, layer_mm, support_angle, layers);
  return layers;
}

}  // namespace packmerger
