#include "shape/surface/repair.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/manifoldness.h>
#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/repair.h>
#include <CGAL/Polygon_mesh_processing/repair_degeneracies.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Polygon_mesh_processing/stitch_borders.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>
#include <CGAL/Surface_mesh.h>

#include "base/error.h"
#include "shape/read/soup.h"
#include "shape/surface/orient.h"
#include "shape/surface/shape_change.h"
#include "shape/surface/t_junctions.h"

namespace packmerger {
namespace {

namespace pmp = CGAL::Polygon_mesh_processing;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using CgalMesh = CGAL::Surface_mesh<Kernel::Point_3>;

// Pieces with a border that hold less of the area than this are debris, not part of the model.
constexpr double kShardArea = 1e-3;
// A hole that reaches over this much of the model in two directions leaves a skin, not a body.
constexpr double kWholeWidth = 0.9;
// Points nearer than this fraction of the diagonal are welded when equal points alone leave holes:
// about what single-precision files lose.
constexpr double kWeldTolerance = 1e-6;

struct Counts {
  int open_edges = 0;
  int degenerate_facets = 0;
  int edges_fixed = 0;
  int facets_removed = 0;
  int facets_reversed = 0;
  int holes_filled = 0;
  int facets_added = 0;
  int swallowed = 0;
  bool is_skin = false;

  bool any() const {
    return open_edges + degenerate_facets + edges_fixed + facets_removed + facets_reversed +
               holes_filled + facets_added + swallowed >
           0;
  }
};

[[noreturn]] void refuse(const std::string& why) {
  throw Error(
      Fault::kBadInput, "No closed surface can be made of the model: " + why,
      "Repair it in a mesh editor (Blender: 3D-Print Toolbox, Make Manifold) and try again.");
}

CgalMesh to_cgal(const Mesh& surface) {
  CgalMesh mesh;
  for (const Vec3& p : surface.points()) mesh.add_vertex({p.x(), p.y(), p.z()});
  using Index = CgalMesh::Vertex_index;
  const auto index = [](int i) { return Index(static_cast<Index::size_type>(i)); };
  for (const auto& [a, b, c] : surface.triangles()) mesh.add_face(index(a), index(b), index(c));
  return mesh;
}

TriangleSoup from_cgal(const CgalMesh& mesh) {
  TriangleSoup soup;
  std::vector<int> number(mesh.num_vertices() + mesh.number_of_removed_vertices(), -1);
  for (const auto vertex : mesh.vertices()) {
    if (mesh.is_isolated(vertex)) continue;
    number[vertex.idx()] = static_cast<int>(soup.points.size());
    const Kernel::Point_3& p = mesh.point(vertex);
    soup.points.emplace_back(p.x(), p.y(), p.z());
  }
  for (const auto face : mesh.faces()) {
    std::array<int, 3> triangle{};
    int i = 0;
    for (const auto vertex : mesh.vertices_around_face(mesh.halfedge(face)))
      triangle[i++] = number[vertex.idx()];
    soup.triangles.push_back(triangle);
  }
  return soup;
}

// Of two ways to turn a piece alike, the one in which most of its triangles were: it may tell a
// cavity from a body within a body.
void turn_as_most_were(const std::vector<Kernel::Point_3>& points,
                       std::vector<std::vector<std::size_t>>& polygons,
                       const TriangleSoup& before) {
  TriangleSoup now;
  for (const Kernel::Point_3& p : points) now.points.emplace_back(p.x(), p.y(), p.z());
  for (const auto& polygon : polygons)
    now.triangles.push_back(
        {static_cast<int>(polygon[0]), static_cast<int>(polygon[1]), static_cast<int>(polygon[2])});
  const Components pieces = components_of(now);
  std::vector<int> votes(static_cast<std::size_t>(pieces.count), 0);
  for (std::size_t i = 0; i < polygons.size(); ++i) {
    // Points may have been doubled, so the corners' places are compared.
    const auto& was = before.triangles[i];
    const auto& is = now.triangles[i];
    const auto first = std::find_if(is.begin(), is.end(), [&](int corner) {
      return now.points[corner] == before.points[was[0]];
    });
    if (first == is.end()) continue;
    const int next = is[static_cast<std::size_t>((first - is.begin() + 1) % 3)];
    votes[pieces.of_triangle[i]] += now.points[next] == before.points[was[1]] ? 1 : -1;
  }
  for (std::size_t i = 0; i < polygons.size(); ++i)
    if (votes[pieces.of_triangle[i]] < 0) std::swap(polygons[i][1], polygons[i][2]);
}

// Neighbouring triangles turned alike; where more than two meet at an edge the sheets are cut
// apart.
CgalMesh oriented(const TriangleSoup& soup) {
  std::vector<Kernel::Point_3> points;
  for (const Vec3& p : soup.points) points.emplace_back(p.x(), p.y(), p.z());
  std::vector<std::vector<std::size_t>> polygons;
  for (const auto& [a, b, c] : soup.triangles)
    polygons.push_back(
        {static_cast<std::size_t>(a), static_cast<std::size_t>(b), static_cast<std::size_t>(c)});
  pmp::orient_polygon_soup(points, polygons);

  turn_as_most_were(points, polygons, soup);
  CgalMesh mesh;
  pmp::polygon_soup_to_polygon_mesh(points, polygons, mesh);
  return mesh;
}

// Whether the border runs around the whole model.
bool spans(const CgalMesh& mesh, CgalMesh::Halfedge_index border, const Vec3& size) {
  Box3 box;
  for (const auto vertex : CGAL::vertices_around_face(border, mesh)) {
    const Kernel::Point_3& p = mesh.point(vertex);
    box.extend(Vec3(p.x(), p.y(), p.z()));
  }
  const Vec3 part = box.sizes().cwiseQuotient(size);
  return (part.array() >= kWholeWidth).count() >= 2;
}

void fill_holes(CgalMesh& mesh, const Vec3& size, Counts& counts, const Progress& progress) {
  std::vector<CgalMesh::Halfedge_index> borders;
  pmp::extract_boundary_cycles(mesh, std::back_inserter(borders));
  for (const auto border : borders) {
    progress.check();
    const bool is_skin = spans(mesh, border, size);
    std::vector<CgalMesh::Face_index> patch;
    pmp::triangulate_hole(mesh, border, std::back_inserter(patch));
    if (patch.empty()) continue;
    ++counts.holes_filled;
    counts.is_skin = counts.is_skin || is_skin;
    counts.facets_added += static_cast<int>(patch.size());
  }
}

int border_edges(const CgalMesh& mesh) {
  const auto halfedges = mesh.halfedges();
  return static_cast<int>(std::count_if(halfedges.begin(), halfedges.end(),
                                        [&](auto halfedge) { return mesh.is_border(halfedge); }));
}

// Edge-connected pieces that have a border and hardly any area.
TriangleSoup without_open_shards(const TriangleSoup& soup, Counts& counts) {
  const double least = kShardArea * area_mm2(soup);
  std::vector<TriangleSoup> parts = split_components(soup);
  TriangleSoup kept;
  for (const TriangleSoup& part : parts) {
    if (area_mm2(part) < least && count_open_edges(part) > 0) {
      counts.facets_removed += static_cast<int>(part.triangles.size());
      continue;
    }
    append(kept, part);
  }
  return kept;
}

// soup becomes what the file's triangles were before they were turned and filled up.
TriangleSoup closed(TriangleSoup& soup, Counts& counts, const Progress& progress) {
  const double diagonal = bounding_box(soup).diagonal().norm();
  counts.open_edges = count_open_edges(soup);
  if (counts.open_edges > 0) {
    soup = welded(soup, kWeldTolerance * diagonal);
    counts.degenerate_facets += drop_collapsed(soup);
    counts.facets_removed += drop_duplicates(soup);
    divide_at_t_junctions(soup, kWeldTolerance * diagonal, progress);
    counts.facets_removed += drop_duplicates(soup);
    counts.edges_fixed += std::max(0, counts.open_edges - count_open_edges(soup));
    soup = welded(without_open_shards(soup, counts), 0);
  }
  if (soup.triangles.empty()) refuse("nothing but loose triangles");
  progress.check();
  try {
    CgalMesh mesh = oriented(soup);
    const int before = border_edges(mesh);
    pmp::stitch_borders(mesh);
    counts.edges_fixed += (before - border_edges(mesh)) / 2;
    fill_holes(mesh, bounding_box(soup).sizes(), counts, progress);
    pmp::remove_degenerate_faces(mesh);
    pmp::duplicate_non_manifold_vertices(mesh);
    return from_cgal(mesh);
  } catch (const CGAL::Failure_exception& failure) {
    refuse("CGAL gave up (" + failure.message() + ")");
  }
}

std::string told(const Counts& counts, int number_of_parts) {
  std::string text;
  const auto add = [&](int count, const std::string& thing, const char* what) {
    if (count == 0) return;
    text += (text.empty() ? "" : ", ") + std::to_string(count) + " " + thing;
    text += (count == 1 ? "" : "s") + std::string(what);
  };
  add(counts.open_edges, "open edge", "");
  add(counts.degenerate_facets, "facet", " without area");
  add(counts.edges_fixed, "edge", " mended");
  add(counts.facets_removed, "facet", " removed");
  add(counts.facets_reversed, "facet", " turned round");
  add(counts.holes_filled, "hole", " filled");
  add(counts.facets_added, "facet", " added");
  add(counts.swallowed, "piece", " within matter left out");
  const std::string pieces = std::to_string(number_of_parts) + " separate pieces";
  return "The model was repaired" + (text.empty() ? "" : ": " + text) +
         (number_of_parts > 1 ? "; it consists of " + pieces : "");
}

}  // namespace

Mesh repair(const TriangleSoup& input, Warnings& warnings, const Progress& progress) {
  progress.report("repairing", 0);
  Counts counts;
  TriangleSoup soup = welded(input, 0);
  counts.degenerate_facets += drop_collapsed(soup);
  counts.facets_removed += drop_duplicates(soup);
  soup = welded(soup, 0);
  if (soup.triangles.size() < 4) refuse("it has fewer than four triangles");
  counts.degenerate_facets += count_flat(soup);
  const TriangleSoup before = soup;
  const bool is_closed = is_closed_manifold(soup);
  TriangleSoup of_file = soup;
  if (counts.degenerate_facets > 0 || !is_closed) soup = closed(of_file, counts, progress);
  progress.report("repairing", 0.7);
  const Orientation orientation = orient_outwards(soup);
  counts.facets_removed += orientation.facets_removed;
  counts.swallowed = orientation.swallowed;
  counts.facets_reversed = count_turned(of_file, soup);
  if (orientation.pieces == 0) refuse("it encloses no volume");
  if (!is_closed_manifold(soup)) refuse("some holes or crossing sheets could not be mended");
  if (counts.any()) warnings.push_back({"repaired", told(counts, orientation.pieces)});
  if (counts.any())
    warn_of_change({before, is_closed, soup, counts.is_skin, counts.swallowed > 0}, warnings,
                   progress);
  Mesh mesh = closed_mesh(std::move(soup));
  progress.report("repairing", 1);
  return mesh;
}

bool self_intersects(const Mesh& mesh) { return pmp::does_self_intersect(to_cgal(mesh)); }

}  // namespace packmerger
