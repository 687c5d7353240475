#include "shape/surface/resample.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/parallel.h"
#include "shape/read/soup.h"
#include "shape/surface/coarsen.h"
#include "shape/surface/distance_grid.h"
#include "shape/surface/outer_hull.h"
#include "shape/surface/repair.h"
#include "shape/surface/surface_query.h"

namespace packmerger {
namespace {

// Voxels that are tried, in tolerances. Since points are moved back to the model, even the first is
// fine enough where there are no narrow gaps and sharp edges.
constexpr std::array<double, 5> kVoxels = {2, 1.2, 0.7, 0.45, 0.3};
constexpr double kBand = 2;  // voxels on both sides
constexpr double kMaxVoxels = 6e7;
constexpr double kCoarsening = 0.2;    // of the tolerance
constexpr double kLongestEdge = 0.04;  // of the diagonal
constexpr double kStep = 0.01;         // of the diagonal, see resample.h
constexpr double kInwards = 0.00731;   // of the way from a border to the triangle's middle
// What is thinner holds nothing and keeps nothing apart, of the tolerance.
constexpr double kThin = 0.5;
// Between sheets of the hull that would touch, of the tolerance.
constexpr double kGap = 0.01;
// By how much a hull is coarsened before it is cut anew, of the tolerance.
constexpr std::array<double, 9> kMends = {0, 0, 0, 0, 0.02, 0.05, 0.1, 0.2, 0.3};
// Components smaller than this many voxels are grains of the grid, not of the model.
constexpr double kGrain = 8;

// Points over each triangle, no further apart than step; the points of one triangle by index.
std::vector<Vec3> spread(const Vec3& a, const Vec3& b, const Vec3& c, double step) {
  const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
  const int n = std::clamp(static_cast<int>(std::ceil(longest / step)), 1, 200);
  std::vector<Vec3> points;
  for (int i = 0; i <= n; ++i)
    for (int j = 0; i + j <= n; ++j)
      points.push_back(a + (b - a) * (static_cast<double>(i) / n) +
                       (c - a) * (static_cast<double>(j) / n));
  return points;
}

// The largest distance from points on soup to target, over those that `counts` accepts; it is asked
// beside the triangle's border, on which other sheets often stand.
template <typename Counts>
double furthest(const TriangleView& soup, const SurfaceQuery& target, double step,
                const Counts& counts, const Progress& progress) {
  std::vector<double> of_triangle(soup.triangles.size(), 0);
  parallel_for(soup.triangles.size(), [&](std::size_t i) {
    progress.check();
    const auto& [a, b, c] = soup.triangles[i];
    const Vec3& pa = soup.points[a];
    const Vec3& pb = soup.points[b];
    const Vec3& pc = soup.points[c];
    const Vec3 normal = (pb - pa).cross(pc - pa).normalized();
    const Vec3 middle = (pa + pb + pc) / 3;
    for (const Vec3& point : spread(pa, pb, pc, step)) {
      const double distance = target.distance_mm(point);
      if (distance > of_triangle[i] && counts(point + kInwards * (middle - point), normal))
        of_triangle[i] = distance;
    }
  });
  return of_triangle.empty() ? 0 : *std::max_element(of_triangle.begin(), of_triangle.end());
}

double deviation(const TriangleView& model, const SurfaceQuery& model_query,
                 const TriangleView& surface, double tolerance_mm, double step,
                 const Progress& progress) {
  const SurfaceQuery surface_query(surface);
  const auto all = [](const Vec3&, const Vec3&) { return true; };
  // Sheets that lie inside other matter are not part of the outside, nor are folds and crevices
  // without thickness.
  const std::array<double, 2> aside{step * 1e-3, kThin * tolerance_mm};
  const auto outside = [&](const Vec3& point, const Vec3& normal) {
    return normal.allFinite() && std::all_of(aside.begin(), aside.end(), [&](double by) {
             return model_query.winding_number(point + by * normal) == 0 &&
                    model_query.winding_number(point - by * normal) != 0;
           });
  };
  return std::max(furthest(surface, model_query, step, all, progress),
                  furthest(model, surface_query, step, outside, progress));
}

std::optional<TriangleSoup> without_grains(const TriangleSoup& soup, double voxel_mm) {
  TriangleSoup kept;
  for (const TriangleSoup& part : split_components(soup)) {
    if (std::abs(signed_volume_mm3(part)) < kGrain * voxel_mm * voxel_mm * voxel_mm) continue;
    append(kept, part);
  }
  if (kept.triangles.empty()) return std::nullopt;
  return kept;
}

// The grid rounds off what is sharp; points go back to the model, but not to another place of it.
TriangleSoup moved_back(TriangleSoup soup, const SurfaceQuery& model, double voxel_mm,
                        const Progress& progress) {
  parallel_for(soup.points.size(), [&](std::size_t i) {
    progress.check();
    const SurfaceQuery::Nearest nearest = model.nearest(soup.points[i]);
    if (nearest.distance_mm < voxel_mm / 2) soup.points[i] = nearest.point;
  });
  return soup;
}

// The coarsest of a few attempts that does not intersect itself; empty when all do.
std::optional<Mesh> clean(const TriangleSoup& fine, const SurfaceQuery& model, double voxel_mm,
                          double tolerance_mm, double max_edge_mm, const Progress& progress) {
  for (const bool move : {true, false}) {
    const Mesh full = closed_mesh(move ? moved_back(fine, model, voxel_mm, progress) : fine);
    for (const double fraction : {1.0, 0.3}) {
      Mesh mesh = coarsened(full, fraction * kCoarsening * tolerance_mm, max_edge_mm, progress);
      if (!self_intersects(mesh)) return mesh;
    }
  }
  return std::nullopt;
}

// Where surfaces are compared, and how closely.
struct Measure {
  Measure(const Mesh& mesh, double tolerance) : model(mesh), query(mesh), tolerance_mm(tolerance) {
    const double size = bounding_box(mesh).diagonal().norm();
    step_mm = std::max(tolerance, kStep * size);
    max_edge_mm = kLongestEdge * size;
  }

  Mesh model;
  SurfaceQuery query;
  double tolerance_mm;
  double step_mm = 0;
  double max_edge_mm = 0;  // of a coarsened surface
  double best_mm = std::numeric_limits<double>::infinity();

  // The surface with its deviation, if it may stand in for the model.
  std::optional<Resampled> accepted(Mesh surface, const Progress& progress) {
    const double found = deviation(model, query, surface, tolerance_mm, step_mm, progress);
    best_mm = std::min(best_mm, found);
    if (found > tolerance_mm) return std::nullopt;
    return Resampled{std::move(surface), found};
  }
};

// The exact outside. Where rounding made its pieces cross again it is cut once more, and then
// coarsened a little, since the smallest pieces cross most easily.
std::optional<Resampled> from_hull(const Mesh& mesh, Measure& measure, const Progress& progress) {
  const double gap_mm = kGap * measure.tolerance_mm;
  std::optional<Mesh> hull = outer_hull(mesh, gap_mm, progress);
  for (const double mend : kMends) {
    if (!hull) return std::nullopt;
    if (!self_intersects(*hull)) return measure.accepted(std::move(*hull), progress);
    if (mend > 0) {
      hull = coarsened(*hull, mend * measure.tolerance_mm, measure.max_edge_mm, progress);
      if (!self_intersects(*hull)) return measure.accepted(std::move(*hull), progress);
    }
    hull = outer_hull(*hull, gap_mm, progress);
  }
  return std::nullopt;
}

std::optional<Resampled> from_grid(const Mesh& mesh, Measure& measure, const Progress& progress) {
  const double area = area_mm2(mesh);
  for (std::size_t round = 0; round < kVoxels.size(); ++round) {
    progress.report("re-sampling", static_cast<double>(round + 1) / (kVoxels.size() + 1));
    const double voxel = kVoxels[round] * measure.tolerance_mm;
    if (area / (voxel * voxel) * (2 * kBand + 4) > kMaxVoxels) break;
    DistanceGrid grid(mesh, voxel, kBand * voxel, kBand * voxel, NarrowSheets::kDrop, progress);
    const auto level = grid.level(0, progress);
    const auto fine = level ? without_grains(*level, voxel) : std::nullopt;
    if (!fine) continue;
    auto surface =
        clean(*fine, measure.query, voxel, measure.tolerance_mm, measure.max_edge_mm, progress);
    if (!surface) continue;
    progress.check();
    if (auto result = measure.accepted(std::move(*surface), progress)) return result;
  }
  return std::nullopt;
}

}  // namespace

Resampled resample(const Mesh& mesh, double tolerance_mm, const Progress& progress) {
  progress.report("re-sampling", 0);
  Measure measure(mesh, tolerance_mm);
  if (auto result = from_hull(mesh, measure, progress)) return std::move(*result);
  return resample_on_grid(mesh, tolerance_mm, progress);
}

Resampled resample_on_grid(const Mesh& mesh, double tolerance_mm, const Progress& progress) {
  Measure measure(mesh, tolerance_mm);
  if (auto result = from_grid(mesh, measure, progress)) return std::move(*result);
  throw Error(Fault::kBadInput,
              "The surface cannot be used as it is and could not be re-sampled within " +
                  std::to_string(tolerance_mm) + " mm" +
                  (std::isfinite(measure.best_mm)
                       ? " (it deviates by " + std::to_string(measure.best_mm) + " mm)"
                       : ""),
              "Raise resample_tolerance_mm, or repair the model in a mesh editor.");
}

}  // namespace packmerger
