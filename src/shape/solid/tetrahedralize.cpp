#include "shape/solid/tetrahedralize.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "base/files.h"
#include "base/process/process.h"
#include "shape/read/soup.h"
#include "shape/solid/inside_point.h"
#include "shape/solid/refine.h"
#include "shape/solid/tetgen_files.h"

namespace packmerger {
namespace {

constexpr int kOutsideMarker = 1;
constexpr int kCavityMarker = 2;
constexpr double kTimeout_s = 600;
// The sanitizers reserve terabytes of addresses, so a build with them sets no limit.
constexpr std::uint64_t kMaxMemoryBytes =
#ifdef PACKMERGER_NO_MEMORY_LIMIT
    0;
#else
    std::uint64_t{8} << 30;
#endif
constexpr double kVolumeTolerance = 1e-3;
// A cluster of fewer tetrahedra would have no smooth border.
constexpr double kPerCluster = 100;

// A regular tetrahedron on longer edges would be too large.
double longest_surface_edge_mm(double max_tetrahedron_mm3) {
  return std::cbrt(max_tetrahedron_mm3 * 6 * std::sqrt(2.0));
}

void add_facets(TetgenInput& input, TriangleSoup soup, int marker, double max_edge_mm) {
  std::vector<int> markers(soup.triangles.size(), marker);
  split_long_edges(soup, markers, max_edge_mm);
  const int base = static_cast<int>(input.points.size());
  input.points.insert(input.points.end(), soup.points.begin(), soup.points.end());
  for (const auto& [a, b, c] : soup.triangles)
    input.facets.push_back({a + base, b + base, c + base});
  input.markers.insert(input.markers.end(), markers.begin(), markers.end());
}

std::string complete_flags(const std::string& flags, double max_volume_mm3) {
  std::string complete = flags;
  if (complete.ends_with('a')) {
    char number[32];
    std::snprintf(number, sizeof number, "%.9f", max_volume_mm3);
    complete += number;
  }
  if (complete.find('Q') == complete.npos) complete += 'Q';
  return complete;
}

TetgenInput input_for(const Shell& shell, const ShapeSettings& settings, double max_volume_mm3) {
  TetgenInput input;
  input.flags = complete_flags(settings.tetgen_flags, max_volume_mm3);
  const double max_edge = longest_surface_edge_mm(max_volume_mm3);
  add_facets(input, to_soup(shell.outer), kOutsideMarker, max_edge);
  for (TriangleSoup& part : split_components(shell.outer))
    if (signed_volume_mm3(part) < 0) input.holes.push_back(point_inside(turned(std::move(part))));
  for (const Mesh& cavity : shell.cavities)
    add_facets(input, to_soup(cavity), kCavityMarker, max_edge);
  input.holes.insert(input.holes.end(), shell.cavity_points.begin(), shell.cavity_points.end());
  return input;
}

// A very flat solid model would be cut into countless facets.
void check_facets(const Shell& shell, double max_volume_mm3) {
  constexpr double kMostFacets = 5e6;
  const double edge = longest_surface_edge_mm(max_volume_mm3);
  double area = area_mm2(shell.outer);
  for (const Mesh& cavity : shell.cavities) area += area_mm2(cavity);
  if (area / (edge * edge / 4) > kMostFacets)
    throw Error(Fault::kBadInput, "The model is too thin for its size to be divided",
                "Print it with --no-split, or make it thicker.");
}

struct TetgenRun {
  std::optional<TetgenOutput> output;  // empty when TetGen refused or died
  bool timed_out = false;
};

TetgenRun run_tetgen(const TetgenInput& input, const Progress& progress) {
  const TemporaryFolder folder;
  const fs::path from = folder.path() / "surface";
  const fs::path to = folder.path() / "tetrahedra";
  write_tetgen_input(from, input);
  ProcessSpec spec;
  spec.argv = {helper_program("packmerger-tetgen").string(), from.string(), to.string()};
  spec.max_memory_bytes = kMaxMemoryBytes;
  const ProcessResult result = run_process(spec, kTimeout_s, progress);
  if (result.status.could_not_start())
    throw Error(Fault::kUnavailable, "packmerger-tetgen cannot be started",
                "Install PackMerger again; packmerger-tetgen alone tells what it lacks.");
  if (!result.status.ok() || !fs::exists(to)) return {std::nullopt, result.timed_out};
  return {read_tetgen_output(to)};
}

// TetGen makes points one that are nearer than 1e-8 of the size. Where bodies were united, points
// may be nearer, and then what does not cross is refused, or TetGen dies: it is tried again with
// all points kept apart, unless the first time was too long already.
std::optional<TetgenOutput> run_keeping_points(TetgenInput input, const Progress& progress) {
  TetgenRun run = run_tetgen(input, progress);
  if (run.output || run.timed_out || input.flags.find('T') != input.flags.npos)
    return std::move(run.output);
  input.flags += "T1e-13";
  return run_tetgen(input, progress).output;
}

std::array<int, 3> sorted(std::array<int, 3> corners) {
  std::sort(corners.begin(), corners.end());
  return corners;
}

// Whether every boundary face lies on a facet.
bool mark_sides(TetMesh& mesh, const TetgenOutput& output) {
  std::map<std::array<int, 3>, int> marker_of;
  for (std::size_t i = 0; i < output.faces.size(); ++i)
    marker_of[sorted(output.faces[i])] = output.markers[i];
  for (int t = 0; t < mesh.count(); ++t)
    for (int face = 0; face < 4; ++face) {
      if (mesh.neighbours[t][face] >= 0) continue;
      const auto marker = marker_of.find(sorted(face_corners(mesh, t, face)));
      if (marker == marker_of.end()) return false;
      if (marker->second != kOutsideMarker && marker->second != kCavityMarker) return false;
      mesh.sides[t][face] =
          marker->second == kOutsideMarker ? FaceSide::kOutside : FaceSide::kCavity;
    }
  return true;
}

// Empty when some tetrahedron is flat or some boundary face belongs to no facet.
std::optional<TetMesh> mesh_of(TetgenOutput&& output) {
  TetMesh mesh;
  mesh.points = std::move(output.points);
  mesh.tetrahedra = std::move(output.tetrahedra);
  for (int t = 0; t < mesh.count(); ++t) {
    if (mesh.volume_mm3(t) < 0) std::swap(mesh.tetrahedra[t][0], mesh.tetrahedra[t][1]);
    if (!(mesh.volume_mm3(t) > 0)) return std::nullopt;
  }
  link_neighbours(mesh);
  if (!mark_sides(mesh, output)) return std::nullopt;
  return mesh;
}

bool all_positive(const TetMesh& mesh) {
  for (int t = 0; t < mesh.count(); ++t)
    if (!(mesh.volume_mm3(t) > 0)) return false;
  return true;
}

}  // namespace

std::optional<TetMesh> tetrahedralize(const Shell& shell, const ShapeSettings& settings,
                                      const Progress& progress) {
  progress.report("making tetrahedra", 0);
  const double max_volume =
      shell.volume_mm3 * std::min(settings.max_tetrahedron_fraction,
                                  1 / (kPerCluster * std::max(1, settings.clusters)));
  check_facets(shell, max_volume);
  auto output = run_keeping_points(input_for(shell, settings, max_volume), progress);
  if (!output) return std::nullopt;
  progress.report("making tetrahedra", 0.8);
  std::optional<TetMesh> mesh = mesh_of(std::move(*output));
  if (!mesh) return std::nullopt;
  const double volume = total_volume_mm3(*mesh);
  if (std::abs(volume - shell.volume_mm3) > kVolumeTolerance * shell.volume_mm3)
    return std::nullopt;
  split_large_tetrahedra(*mesh, max_volume);
  if (!all_positive(*mesh)) return std::nullopt;
  progress.report("making tetrahedra", 1);
  return mesh;
}

}  // namespace packmerger
