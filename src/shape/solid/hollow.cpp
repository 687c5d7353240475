#include "shape/solid/hollow.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/parallel.h"
#include "shape/read/soup.h"
#include "shape/solid/inside_point.h"
#include "shape/surface/coarsen.h"
#include "shape/surface/distance_grid.h"
#include "shape/surface/repair.h"
#include "shape/surface/surface_query.h"

namespace packmerger {
namespace {

// Least wall that is accepted after sampling and coarsening, as a fraction of wall_mm.
constexpr double kLeastWall = 0.9;
// Coarsening may move the cavity's surface by this fraction of the wall.
constexpr double kCoarsening = 0.03;
// Longest edge of a cavity's surface, in walls: triangles much longer than the wall is thick make
// flat tetrahedra.
constexpr double kLongestEdge = 2;
constexpr double kThinShare = 0.5;
// Points of a cavity's surface that are asked which side of the model's they lie on. Rays that meet
// an edge err now and then, but not this often.
constexpr std::size_t kAsked = 1000;
constexpr double kErring = 0.05;

double distance_to(const SurfaceQuery& outer, const TriangleView& soup) {
  std::vector<double> distances(soup.triangles.size());
  parallel_for(soup.triangles.size(), [&](std::size_t i) {
    const auto& [a, b, c] = soup.triangles[i];
    const Vec3& pa = soup.points[a];
    const Vec3& pb = soup.points[b];
    const Vec3& pc = soup.points[c];
    double least = outer.distance_mm((pa + pb + pc) / 3);
    for (const Vec3& p :
         {pa, pb, pc, Vec3((pa + pb) / 2), Vec3((pb + pc) / 2), Vec3((pc + pa) / 2)})
      least = std::min(least, outer.distance_mm(p));
    distances[i] = least;
  });
  return *std::min_element(distances.begin(), distances.end());
}

bool is_good(const Mesh& boundary, const SurfaceQuery& outer, double wall_mm) {
  return distance_to(outer, boundary) >= kLeastWall * wall_mm && !self_intersects(boundary);
}

// The grid rounds off edges; points that came too near to the outer surface go back to the depth.
TriangleSoup pushed_to_depth(TriangleSoup soup, const SurfaceQuery& outer, double wall_mm) {
  parallel_for(soup.points.size(), [&](std::size_t i) {
    Vec3& point = soup.points[i];
    const SurfaceQuery::Nearest nearest = outer.nearest(point);
    if (nearest.distance_mm > 0 && nearest.distance_mm < wall_mm)
      point += (point - nearest.point) * (wall_mm / nearest.distance_mm - 1);
  });
  return soup;
}

// The cavity's boundary with fewer triangles; empty when no attempt keeps the wall.
std::optional<Mesh> coarse_boundary(TriangleSoup fine, const SurfaceQuery& outer, double wall_mm,
                                    const Progress& progress) {
  const Mesh pushed = closed_mesh(pushed_to_depth(std::move(fine), outer, wall_mm));
  for (const double fraction : {1.0, 0.4, 0.1}) {
    Mesh coarse =
        coarsened(pushed, fraction * kCoarsening * wall_mm, kLongestEdge * wall_mm, progress);
    if (is_good(coarse, outer, wall_mm)) return coarse;
  }
  if (is_good(pushed, outer, wall_mm)) return pushed;
  return std::nullopt;
}

// A chamber with a narrow way out, such as a drain hole that no voxel lies in, counts as inside for
// the grid. Its level lies in the void. And a cavity in what is enclosed twice would still be
// enclosed once. A level keeps away from the surface, so that all of a component is on one side.
bool is_enclosed_once(const TriangleSoup& level, const SurfaceQuery& outer) {
  const std::size_t step = std::max<std::size_t>(1, level.points.size() / kAsked);
  std::vector<char> once((level.points.size() + step - 1) / step);
  parallel_for(once.size(), [&](std::size_t i) {
    once[i] = outer.winding_number(level.points[i * step]) == 1 ? 1 : 0;
  });
  const auto count = std::count(once.begin(), once.end(), 1);
  const double share = static_cast<double>(count) / static_cast<double>(once.size());
  if (share > kErring && share < 1 - kErring)
    throw Error(Fault::kBadInput, "It cannot be told where the model's matter is",
                "Repair the model in a mesh editor (remesh it with voxels), or prepare it solid.");
  return share > 0.5;
}

// The boundaries of the cavities at a depth of at least wall_mm, normals pointing away from the
// hollow. Deeper levels are tried where the grid is too coarse for one.
std::vector<Mesh> boundaries(DistanceGrid& grid, const SurfaceQuery& outer,
                             const ShapeSettings& settings, const Progress& progress) {
  for (const double extra : {0.0, 0.5, 1.0}) {
    const double depth = settings.wall_mm + extra * settings.voxel_mm;
    std::vector<Mesh> all;
    const std::optional<TriangleSoup> level = grid.level(-depth, progress);
    if (!level) continue;
    bool good = true;
    for (TriangleSoup& fine : split_components(*level)) {
      // Islands of matter in a cavity have a negative volume.
      if (!good || signed_volume_mm3(fine) < settings.min_cavity_mm3) continue;
      if (!is_enclosed_once(fine, outer)) continue;
      progress.report("hollowing", 0.6);
      auto coarse = coarse_boundary(std::move(fine), outer, settings.wall_mm, progress);
      good = coarse.has_value();
      if (coarse) all.push_back(std::move(*coarse));
    }
    if (good) return all;
  }
  throw Error(Fault::kBadInput, "The inner surface crosses itself at this wall thickness",
              "Change wall_mm or lower voxel_mm a little and try again.");
}

// The model's own cavities whose wall would float free in the new cavities join them.
Mesh without_swallowed_cavities(const Mesh& outer, const std::vector<Mesh>& hollows) {
  std::vector<TriangleSoup> parts = split_components(outer);
  if (parts.size() == 1 || hollows.empty()) return outer;
  std::vector<SurfaceQuery> queries;
  for (const Mesh& hollow : hollows) queries.emplace_back(hollow);
  std::vector<Mesh> kept;
  for (TriangleSoup& part : parts) {
    const bool swallowed = std::any_of(queries.begin(), queries.end(), [&](const auto& query) {
      return query.winding_number(part.points[0]) != 0;
    });
    if (!swallowed) kept.push_back(closed_mesh(std::move(part)));
  }
  if (kept.size() == parts.size()) return outer;
  std::vector<const Mesh*> meshes;
  for (const Mesh& mesh : kept) meshes.push_back(&mesh);
  return united(meshes);
}

// Share of the outer surface below which there are less than two walls of matter.
double thin_share(const Mesh& outer, const SurfaceQuery& query, double wall_mm) {
  const TriangleView soup(outer);
  std::vector<double> areas(soup.triangles.size());
  std::vector<char> thin(soup.triangles.size());
  parallel_for(soup.triangles.size(), [&](std::size_t i) {
    const auto& [a, b, c] = soup.triangles[i];
    const Vec3 normal = (soup.points[b] - soup.points[a]).cross(soup.points[c] - soup.points[a]);
    areas[i] = normal.norm() / 2;
    if (!(areas[i] > 0)) return;
    const Vec3 middle = (soup.points[a] + soup.points[b] + soup.points[c]) / 3;
    const auto depth = query.ray_mm(middle, -normal.normalized());
    thin[i] = depth && *depth < 2 * wall_mm ? 1 : 0;
  });
  double all = 0;
  double below = 0;
  for (std::size_t i = 0; i < areas.size(); ++i) {
    all += areas[i];
    below += thin[i] != 0 ? areas[i] : 0;
  }
  return all > 0 ? below / all : 0;
}

std::string rounded(double number) { return std::to_string(std::llround(number)); }

void warn(const Shell& shell, double thin, Warnings& warnings) {
  if (!shell.cavities.empty()) {
    double space = 0;
    for (const Mesh& cavity : shell.cavities) space += std::abs(volume_mm3(cavity));
    const std::size_t count = shell.cavities.size();
    const std::string where =
        count == 1 ? "a sealed cavity of " : std::to_string(count) + " sealed cavities, in all ";
    const std::string size =
        space < 1000 ? rounded(space) + " mm³" : rounded(space / 1000) + " cm³";
    warnings.push_back(
        {"sealed_cavity",
         "Printed in one piece, the hollowed model traps support or powder in " + where + size});
  }
  if (thin > kThinShare)
    warnings.push_back({"thin_features", rounded(100 * thin) +
                                             " % of the surface has less than two walls of matter "
                                             "below it: parts will be small and hard to assemble"});
}

}  // namespace

Shell solid_shell(const Mesh& outer, const ShapeSettings& settings) {
  Shell shell;
  shell.outer = outer;
  shell.wall_mm = settings.wall_mm;
  shell.volume_mm3 = volume_mm3(outer);
  return shell;
}

Shell hollow(const Mesh& outer, const ShapeSettings& settings, Warnings& warnings,
             const Progress& progress) {
  progress.report("hollowing", 0);
  const double wall = settings.wall_mm;
  DistanceGrid grid(outer, settings.voxel_mm, wall + settings.voxel_mm, 0, NarrowSheets::kCount,
                    progress);
  progress.report("hollowing", 0.4);
  const SurfaceQuery query(outer);
  const std::vector<Mesh> hollows = boundaries(grid, query, settings, progress);
  Shell shell = solid_shell(without_swallowed_cavities(outer, hollows), settings);
  for (const Mesh& boundary : hollows) {
    shell.cavity_points.push_back(point_inside(boundary));
    shell.cavities.push_back(closed_mesh(turned(to_soup(boundary))));
    shell.volume_mm3 += volume_mm3(shell.cavities.back());  // negative
  }
  if (!(shell.volume_mm3 > 0))
    throw Error(Fault::kBadInput, "Hollowing would leave nothing of the model",
                "Repair the model in a mesh editor (remesh it with voxels), or prepare it solid.");
  warn(shell, thin_share(outer, query, wall), warnings);
  progress.report("hollowing", 1);
  return shell;
}

}  // namespace packmerger
