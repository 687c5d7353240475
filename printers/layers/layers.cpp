#include "printers/layers/layers.h"

#include <algorithm>
#include <cmath>

namespace packmerger {
namespace {

constexpr double kRounding = 1e-6;  // of a layer

}  // namespace

int layer_count(double height_mm, double layer_mm) {
  return std::max(0, static_cast<int>(std::ceil(height_mm / layer_mm - kRounding)));
}

double top_of(const std::vector<const Mesh*>& parts) {
  double top_mm = 0;
  for (const Mesh* part : parts)
    if (!part->empty()) top_mm = std::max(top_mm, bounding_box(*part).max().z());
  return top_mm;
}

LayerRange layers_between(double low_mm, double high_mm, double layer_mm, int count) {
  const auto planes_at_or_below = [&](double z_mm) {
    return std::clamp(static_cast<int>(std::floor(z_mm / layer_mm - 0.5)) + 1, 0, count);
  };
  return {planes_at_or_below(low_mm), planes_at_or_below(high_mm)};
}

}  // namespace packmerger
