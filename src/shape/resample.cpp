#include "shape/resample.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "base/error.h"
#include "base/parallel.h"
#include "shape/coarsen.h"
#include "shape/distance_grid.h"
#include "shape/repair.h"
#include "shape/soup.h"
#include "shape/surface_query.h"

namespace packmerger {
namespace {

// The first grid's voxel, and how much finer each next one is.
constexpr double kFirstVoxel = 0.7;
constexpr double kFiner = 0.7;
constexpr int kRounds = 4;
constexpr double kBand = 3;  // voxels on both sides
constexpr double kMaxVoxels = 6e7;
constexpr double kCoarsening = 0.3;  // of the tolerance
constexpr double kLongestEdge = 0.04;  // of the diagonal
// Components smaller than this many voxels are grains of the grid, not of the model.
constexpr double kGrain = 8;

// Points over each triangle, no further apart than step; the points of one triangle by index.
std::vector<Vec3> spread(const Vec3& a, const Vec3& b, const Vec3& c, double step) {
  const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
  const int n = std::clamp(static_cast<int>(std::ceil(longest / step)), 1, 200);
  std::vector<Vec3> points;
  for (int i = 0; i <= n; ++i)
    for (int j = 0; i + j <= n; ++j)
      points.push_back(a + (b - a) * (static_cast<double>(i) / n) + (c - a) * (static_cast<double>(j) / n));
  return points;
}

// The largest distance from points on soup to target, over points that `counts` accepts.
template <typename Counts>
double furthest(const TriangleSoup& soup, const SurfaceQuery& target, double step, const Counts& counts) {
  std::vector<double> of_triangle(soup.triangles.size(), 0);
  parallel_for(soup.triangles.size(), [&](std::size_t i) {
    const auto& [a, b, c] = soup.triangles[i];
    const Vec3& pa = soup.points[a];
    const Vec3& pb = soup.points[b];
    const Vec3& pc = soup.points[c];
    const Vec3 normal = (pb - pa).cross(pc - pa).normalized();
    for (const Vec3& point : spread(pa, pb, pc, step)) {
      const double distance = target.distance_mm(point);
      if (distance > of_triangle[i] && counts(point, normal)) of_triangle[i] = distance;
    }
  });
  return of_triangle.empty() ? 0 : *std::max_element(of_triangle.begin(), of_triangle.end());
}

double deviation(const TriangleSoup& model, const SurfaceQuery& model_query,
                 const TriangleSoup& surface, double step) {
  const SurfaceQuery surface_query(surface);
  const auto all = [](const Vec3&, const Vec3&) { return true; };
  // Sheets that lie inside other matter are not part of the outside.
  const double above = step * 1e-3;
  const auto outside = [&](const Vec3& point, const Vec3& normal) {
    return normal.allFinite() && model_query.winding_number(point + above * normal) == 0;
  };
  return std::max(furthest(surface, model_query, step, all),
                  furthest(model, surface_query, step, outside));
}

std::optional<TriangleSoup> without_grains(const TriangleSoup& soup, double voxel_mm) {
  TriangleSoup kept;
  for (const TriangleSoup& part : split_components(soup)) {
    if (std::abs(signed_volume_mm3(part)) < kGrain * voxel_mm * voxel_mm * voxel_mm) continue;
    const int base = static_cast<int>(kept.points.size());
    kept.points.insert(kept.points.end(), part.points.begin(), part.points.end());
    for (const auto& [a, b, c] : part.triangles)
      kept.triangles.push_back({a + base, b + base, c + base});
  }
  if (kept.triangles.empty()) return std::nullopt;
  return kept;
}

// The coarsest of a few attempts that does not intersect itself.
Mesh coarse(const TriangleSoup& fine, double tolerance_mm, double max_edge_mm) {
  double tolerance = kCoarsening * tolerance_mm;
  for (int i = 0; i < 2; ++i, tolerance /= 3) {
    Mesh mesh = closed_mesh(coarsened(fine, tolerance, max_edge_mm));
    if (!self_intersects(mesh)) return mesh;
  }
  return closed_mesh(fine);
}

}  // namespace

Resampled resample(const Mesh& mesh, double tolerance_mm, const Progress& progress) {
  const TriangleSoup model = to_soup(mesh);
  const SurfaceQuery query(model);
  const double size = bounding_box(mesh).diagonal().norm();
  const double step = std::max(tolerance_mm, size / 100);
  const double area = area_mm2(mesh);
  double voxel = kFirstVoxel * tolerance_mm;
  double best = 0;
  for (int round = 0; round < kRounds; ++round, voxel *= kFiner) {
    progress.report("re-sampling", static_cast<double>(round) / kRounds);
    if (area / (voxel * voxel) * (2 * kBand + 4) > kMaxVoxels) break;
    DistanceGrid grid(mesh, voxel, kBand * voxel, kBand * voxel, progress);
    const auto fine = without_grains(grid.level(0, progress), voxel);
    if (!fine) continue;
    Resampled result;
    result.surface = coarse(*fine, tolerance_mm, kLongestEdge * size);
    progress.check();
    result.deviation_mm = deviation(model, query, to_soup(result.surface), step);
    if (result.deviation_mm <= tolerance_mm && !self_intersects(result.surface)) return result;
    best = result.deviation_mm;
  }
  throw Error(Fault::kBadInput,
              "The surface intersects itself and could not be re-sampled within " +
                  std::to_string(tolerance_mm) + " mm" +
                  (best > 0 ? " (it deviates by " + std::to_string(best) + " mm)" : ""),
              "Raise resample_tolerance_mm, or repair the model in a mesh editor.");
}

}  // namespace packmerger
