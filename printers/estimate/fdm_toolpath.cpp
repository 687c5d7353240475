#include "printers/estimate/fdm_toolpath.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "printers/layers/support_volume.h"

namespace packmerger {
namespace {

constexpr double kSolidIslandMm2 = 70;  // smaller islands are filled solid (the slicer's default)
constexpr double kAnchorMm = 3;         // by which solid fill grows into the sparse one
constexpr double kInterfaceLayers = 2;

}  // namespace

Bead bead(const FdmSettings& settings, double layer_mm) {
  const double corner = layer_mm * (1 - std::numbers::pi / 4);
  return {settings.line_width_mm - corner, (settings.line_width_mm - corner) * layer_mm};
}

LayerPath layer_path(const FdmSettings& settings, double layer_mm, const Layer& layer,
                     double exposed_mm2) {
  const double spacing_mm = bead(settings, layer_mm).spacing_mm;
  double fill_mm2 = 0;      // inside the shells
  double solid_mm2 = 0;     // of that, small islands
  double perimeter_mm = 0;  // around what is filled
  for (const Island& island : islands_of(layer)) {
    const double inner_mm2 =
        island.area_mm2 - (settings.shells - 0.5) * spacing_mm * island.perimeter_mm;
    if (inner_mm2 <= 0) continue;
    fill_mm2 += inner_mm2;
    perimeter_mm += island.perimeter_mm;
    if (inner_mm2 < kSolidIslandMm2) solid_mm2 += inner_mm2;
  }
  if (exposed_mm2 > 0 && fill_mm2 > 0) {
    const double margin_mm2 = kAnchorMm * perimeter_mm * std::sqrt(exposed_mm2 / fill_mm2);
    solid_mm2 = std::min(fill_mm2, solid_mm2 + exposed_mm2 + margin_mm2);
  }
  LayerPath path;
  path.external_mm = layer.perimeter_mm;
  path.internal_mm = (settings.shells - 1) * layer.perimeter_mm;
  path.solid_mm = solid_mm2 / spacing_mm;
  path.sparse_mm = (fill_mm2 - solid_mm2) * settings.infill_fraction / spacing_mm;
  // the mean chord of a region is π · area / perimeter
  if (fill_mm2 > 0)
    path.fill_lines =
        (path.solid_mm + path.sparse_mm) * perimeter_mm / (std::numbers::pi * fill_mm2);
  return path;
}

double layer_time_s(const FdmSettings& settings, const LayerPath& path) {
  const double speed = settings.speed_mm_s;
  const double slack = std::max(0.0, speed - settings.jerk_mm_s);
  const double turn_s = slack * slack / (speed * settings.acceleration_mm_s2);
  const double time_s =
      (1 + settings.overhead_factor) *
      (path.external_mm / settings.external_speed_mm_s +
       (path.internal_mm + path.solid_mm + path.sparse_mm) / speed + path.fill_lines * turn_s);
  const double slowest_s = path.total_mm() / settings.min_speed_mm_s;
  return std::max(time_s, std::min(settings.min_layer_s, slowest_s));
}

std::vector<double> exposed_areas(const FdmSettings& settings, double layer_mm,
                                  const std::vector<const Mesh*>& parts, int count) {
  std::vector<double> exposed(count, 0.0);
  const double shells_mm = settings.shells * settings.line_width_mm;
  const double depth_mm = settings.solid_layers * layer_mm;
  for (const Mesh* part : parts) {
    for (std::size_t i = 0; i < part->n_triangles(); ++i) {
      const auto [a, b, c] = part->corners(i);
      const Vec3 normal = (b - a).cross(c - a) / 2;
      const double flat_mm2 = std::abs(normal.z());
      const double wall_mm2 = normal.head<2>().norm();
      // how far a slope recedes within the depth; the shells cover the first of it
      if (flat_mm2 * depth_mm <= wall_mm2 * shells_mm) continue;
      const double share = 1 - wall_mm2 * shells_mm / (flat_mm2 * depth_mm);
      const auto [low, high] = std::minmax({a.z(), b.z(), c.z()});
      const double from_mm = normal.z() > 0 ? low - depth_mm : low;
      const int first = std::clamp(static_cast<int>(std::lround(from_mm / layer_mm)), 0, count);
      const int span =
          settings.solid_layers + static_cast<int>(std::lround((high - low) / layer_mm));
      const double each_mm2 = flat_mm2 * share * settings.solid_layers / std::max(1, span);
      for (int layer = first; layer < std::min(count, first + span); ++layer)
        exposed[layer] += each_mm2;
    }
  }
  return exposed;
}

double support_time_s(const FdmSettings& settings, double layer_mm, double support_mm3,
                      double interface_mm2) {
  const double width_mm = settings.line_width_mm;
  const double length_mm = support_mm3 / layer_mm / (settings.support_spacing_mm + width_mm) +
                           kInterfaceLayers * interface_mm2 / width_mm;
  return (1 + settings.overhead_factor) * settings.support_time_factor * length_mm /
             settings.speed_mm_s +
         settings.interface_s_per_mm2 * interface_mm2;
}

void add_tool_path(PrintTerms& terms, const Profile& profile,
                   const std::vector<const Mesh*>& parts) {
  const FdmSettings& settings = profile.fdm;
  double path_mm = 0;
  const std::vector<Layer> layers = slice_layers(parts, profile.layer_mm);
  const std::vector<double> exposed =
      exposed_areas(settings, profile.layer_mm, parts, static_cast<int>(layers.size()));
  for (std::size_t i = 0; i < layers.size(); ++i) {
    const LayerPath path = layer_path(settings, profile.layer_mm, layers[i], exposed[i]);
    path_mm += path.total_mm();
    terms.path_s += layer_time_s(settings, path);
  }
  const SupportMeasure support = support_measure(parts, radians(profile.support_angle_deg));
  const double bridged = 1 - settings.level_support_fraction;
  const double held_mm2 = support.interface_mm2 - bridged * support.level_interface_mm2;
  const double held_mm3 = support.volume_mm3 - bridged * support.level_volume_mm3;
  terms.path_s += support_time_s(settings, profile.layer_mm, held_mm3, held_mm2);
  terms.held_mm3 += held_mm3;
  terms.layers += static_cast<double>(layers.size());
  terms.model_mm3 += path_mm * bead(settings, profile.layer_mm).area_mm2;
  terms.support_mm3 += support.volume_mm3;
}

}  // namespace packmerger
