#include "printers/layers/slice_layers.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "printers/layers/layers.h"

namespace packmerger {
namespace {

// Cuts one part at one height. `facets` holds, sorted, at least every facet the plane meets.
class Cut {
 public:
  Cut(const Mesh& part, double z_mm, const std::vector<int>& facets, Layer& layer)
      : part_(part), z_mm_(z_mm), facets_(facets), layer_(layer), seen_(facets.size(), false) {}

  void run() {
    for (std::size_t i = 0; i < facets_.size(); ++i)
      if (!seen_[i]) trace(facets_[i]);
  }

 private:
  const Vec3& corner(int facet, int k) const {
    return part_.points()[part_.triangles()[facet][k % 3]];
  }
  bool above(const Vec3& point) const { return point.z() >= z_mm_; }

  // The number of the facet's edge along which the outline, matter on its left, leaves it: the one
  // that goes up through the plane. -1 where the plane misses the facet.
  int exit_of(int facet) const {
    for (int k = 0; k < 3; ++k)
      if (!above(corner(facet, k)) && above(corner(facet, k + 1))) return k;
    return -1;
  }

  Vec2 point_on(int facet, int edge) const {
    const Vec3& low = corner(facet, edge);
    const Vec3& high = corner(facet, edge + 1);
    return (low + (high - low) * ((z_mm_ - low.z()) / (high.z() - low.z()))).head<2>();
  }

  void mark(int facet) {
    seen_[std::lower_bound(facets_.begin(), facets_.end(), facet) - facets_.begin()] = true;
  }

  // Follows one contour from facet to facet until it is closed.
  void trace(int start) {
    int edge = exit_of(start);
    if (edge < 0) return;
    Contour contour;
    const Vec2 origin = point_on(start, edge);  // near the contour, for precision
    Vec2 previous = origin;
    double twice_area = 0;
    for (int facet = start;;) {
      mark(facet);
      contour.box.extend(previous);
      facet = part_.neighbours()[facet][edge];
      edge = exit_of(facet);
      const Vec2 next = point_on(facet, edge);
      contour.perimeter_mm += (next - previous).norm();
      const Vec2 a = previous - origin;
      const Vec2 b = next - origin;
      twice_area += a.x() * b.y() - a.y() * b.x();
      previous = next;
      if (facet == start) break;
    }
    contour.area_mm2 = twice_area / 2;
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
  for (std::size_t i = 0; i < part.n_triangles(); ++i) {
    const auto [a, b, c] = part.corners(i);
    const auto [low, high] = std::minmax({a.z(), b.z(), c.z()});
    // one layer more on either side: rounding decides nothing here, Cut does
    const LayerRange range = layers_between(low, high, layer_mm, count);
    for (int layer = std::max(0, range.first - 1); layer < std::min(count, range.end + 1); ++layer)
      facets[layer].push_back(static_cast<int>(i));
  }
  return facets;
}

void add_up(Layer& layer) {
  for (const Contour& contour : layer.contours) {
    layer.area_mm2 += contour.area_mm2;
    layer.perimeter_mm += contour.perimeter_mm;
  }
}

}  // namespace

std::vector<Island> islands_of(const Layer& layer) {
  std::vector<Island> islands;
  for (const Contour& contour : layer.contours)
    if (contour.area_mm2 > 0) islands.push_back({&contour, contour.area_mm2, contour.perimeter_mm});
  for (const Contour& hole : layer.contours) {
    if (hole.area_mm2 > 0) continue;
    Island* around = nullptr;  // the smallest that can hold it
    for (Island& island : islands)
      if (island.outline->box.contains(hole.box) &&
          (around == nullptr || island.outline->area_mm2 < around->outline->area_mm2))
        around = &island;
    if (around == nullptr) continue;  // only where contours cross: not worth more
    around->area_mm2 += hole.area_mm2;
    around->perimeter_mm += hole.perimeter_mm;
  }
  return islands;
}

Layer slice_at(const Mesh& part, double z_mm) {
  std::vector<int> met;
  for (std::size_t i = 0; i < part.n_triangles(); ++i) {
    const auto [a, b, c] = part.corners(i);
    const auto [low, high] = std::minmax({a.z(), b.z(), c.z()});
    if (low <= z_mm && z_mm <= high) met.push_back(static_cast<int>(i));
  }
  Layer layer;
  Cut(part, z_mm, met, layer).run();
  add_up(layer);
  return layer;
}

std::vector<Layer> slice_layers(const std::vector<const Mesh*>& parts, double layer_mm) {
  const int count = layer_count(top_of(parts), layer_mm);
  std::vector<Layer> layers(count);
  for (const Mesh* part : parts) {
    const std::vector<std::vector<int>> facets = facets_by_layer(*part, layer_mm, count);
    parallel_for(static_cast<std::size_t>(count), [&](std::size_t layer) {
      const double z_mm = (static_cast<double>(layer) + 0.5) * layer_mm;
      Cut(*part, z_mm, facets[layer], layers[layer]).run();
    });
  }
  for (Layer& layer : layers) add_up(layer);
  return layers;
}

}  // namespace packmerger
