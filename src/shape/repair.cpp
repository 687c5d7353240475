#include "shape/repair.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <memory>
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
#include "shape/soup.h"
#include "shape/surface_query.h"

namespace packmerger {
namespace {

namespace pmp = CGAL::Polygon_mesh_processing;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using CgalMesh = CGAL::Surface_mesh<Kernel::Point_3>;

// Pieces with a border that hold less of the area than this are debris, not part of the model.
constexpr double kShardArea = 1e-3;
// A closed piece whose volume is below this fraction of its box's diagonal cubed is a flat sheet.
constexpr double kFlatVolume = 1e-9;
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

  bool any() const {
    return open_edges + degenerate_facets + edges_fixed + facets_removed + facets_reversed +
               holes_filled + facets_added >
           0;
  }
};

[[noreturn]] void refuse(const std::string& why) {
  throw Error(
      Fault::kBadInput, "No closed surface can be made of the model: " + why,
      "Repair it in a mesh editor (Blender: 3D-Print Toolbox, Make Manifold) and try again.");
}

CgalMesh to_cgal(const TriangleSoup& soup) {
  CgalMesh mesh;
  for (const Vec3& p : soup.points) mesh.add_vertex({p.x(), p.y(), p.z()});
  using Index = CgalMesh::Vertex_index;
  const auto index = [](int i) { return Index(static_cast<Index::size_type>(i)); };
  for (const auto& [a, b, c] : soup.triangles) mesh.add_face(index(a), index(b), index(c));
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

// Neighbouring triangles turned alike; where more than two meet at an edge the sheets are cut
// apart.
CgalMesh oriented(const TriangleSoup& soup, Counts& counts) {
  std::vector<Kernel::Point_3> points;
  for (const Vec3& p : soup.points) points.emplace_back(p.x(), p.y(), p.z());
  std::vector<std::vector<std::size_t>> polygons;
  for (const auto& [a, b, c] : soup.triangles)
    polygons.push_back(
        {static_cast<std::size_t>(a), static_cast<std::size_t>(b), static_cast<std::size_t>(c)});
  pmp::orient_polygon_soup(points, polygons);

  int reversed = 0;
  for (std::size_t i = 0; i < polygons.size(); ++i) {
    // Vertices may have been doubled, so the corners' places are compared.
    const auto& before = soup.triangles[i];
    const auto place = [&](std::size_t corner) {
      return Vec3(points[corner].x(), points[corner].y(), points[corner].z());
    };
    const auto first =
        std::find_if(polygons[i].begin(), polygons[i].end(),
                     [&](std::size_t corner) { return place(corner) == soup.points[before[0]]; });
    if (first == polygons[i].end()) continue;
    const std::size_t next =
        polygons[i][static_cast<std::size_t>((first - polygons[i].begin() + 1) % 3)];
    if (place(next) != soup.points[before[1]]) ++reversed;
  }
  // Which of the two ways is turned is arbitrary until the outside is known.
  counts.facets_reversed += std::min(reversed, static_cast<int>(polygons.size()) - reversed);
  CgalMesh mesh;
  pmp::polygon_soup_to_polygon_mesh(points, polygons, mesh);
  return mesh;
}

void fill_holes(CgalMesh& mesh, Counts& counts, const Progress& progress) {
  std::vector<CgalMesh::Halfedge_index> borders;
  pmp::extract_boundary_cycles(mesh, std::back_inserter(borders));
  for (const auto border : borders) {
    progress.check();
    std::vector<CgalMesh::Face_index> patch;
    pmp::triangulate_hole(mesh, border, std::back_inserter(patch));
    if (patch.empty()) continue;
    ++counts.holes_filled;
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

TriangleSoup closed(TriangleSoup soup, Counts& counts, const Progress& progress) {
  const double diagonal = bounding_box(soup).diagonal().norm();
  counts.open_edges = count_open_edges(soup);
  if (counts.open_edges > 0) {
    soup = welded(soup, kWeldTolerance * diagonal);
    counts.degenerate_facets += drop_collapsed(soup);
    counts.facets_removed += drop_duplicates(soup);
    counts.edges_fixed += std::max(0, counts.open_edges - count_open_edges(soup));
    soup = welded(without_open_shards(soup, counts), 0);
  }
  if (soup.triangles.empty()) refuse("nothing but loose triangles");
  progress.check();
  try {
    CgalMesh mesh = oriented(soup, counts);
    const int before = border_edges(mesh);
    pmp::stitch_borders(mesh);
    counts.edges_fixed += (before - border_edges(mesh)) / 2;
    fill_holes(mesh, counts, progress);
    pmp::remove_degenerate_faces(mesh);
    pmp::duplicate_non_manifold_vertices(mesh);
    return from_cgal(mesh);
  } catch (const CGAL::Failure_exception& failure) {
    refuse("CGAL gave up (" + failure.message() + ")");
  }
}

bool inside(const TriangleSoup& inner, const SurfaceQuery& outer) {
  return std::all_of(inner.points.begin(), inner.points.end(),
                     [&](const Vec3& point) { return outer.winding_number(point) % 2 != 0; });
}

// How many other components hold each one entirely.
std::vector<int> nesting_depths(const std::vector<TriangleSoup>& parts) {
  std::vector<int> depths(parts.size(), 0);
  std::vector<Box3> boxes;
  for (const TriangleSoup& part : parts) boxes.push_back(bounding_box(part));
  for (std::size_t outer = 0; outer < parts.size(); ++outer) {
    std::unique_ptr<SurfaceQuery> query;
    for (std::size_t inner = 0; inner < parts.size(); ++inner) {
      if (inner == outer || !boxes[outer].contains(boxes[inner])) continue;
      if (!query) query = std::make_unique<SurfaceQuery>(parts[outer]);
      if (inside(parts[inner], *query)) ++depths[inner];
    }
  }
  return depths;
}

// Each component out of the matter: one held by an odd number of others is a cavity. Flat sheets
// go.
int orient_outwards(TriangleSoup& soup, Counts& counts) {
  const double diagonal = bounding_box(soup).diagonal().norm();
  const Components components = components_of(soup);
  const std::vector<TriangleSoup> parts = split_components(soup);
  const std::vector<int> depths = nesting_depths(parts);
  enum class Fate { kKeep, kTurn, kDrop };
  std::vector<Fate> fates;
  int kept = 0;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const double volume = signed_volume_mm3(parts[i]);
    const bool is_flat = std::abs(volume) <= kFlatVolume * diagonal * diagonal * diagonal;
    const bool is_cavity = depths[i] % 2 == 1;
    fates.push_back(is_flat ? Fate::kDrop : (volume < 0) != is_cavity ? Fate::kTurn : Fate::kKeep);
    kept += is_flat ? 0 : 1;
    if (fates.back() == Fate::kTurn)
      counts.facets_reversed += static_cast<int>(parts[i].triangles.size());
  }
  std::vector<std::array<int, 3>> triangles;
  for (std::size_t i = 0; i < soup.triangles.size(); ++i) {
    const Fate fate = fates[static_cast<std::size_t>(components.of_triangle[i])];
    if (fate == Fate::kDrop) {
      ++counts.facets_removed;
      continue;
    }
    triangles.push_back(soup.triangles[i]);
    if (fate == Fate::kTurn) std::swap(triangles.back()[1], triangles.back()[2]);
  }
  soup.triangles = std::move(triangles);
  soup = without_unused_points(soup);
  return kept;
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
  if (counts.degenerate_facets > 0 || !is_closed_manifold(soup))
    soup = closed(std::move(soup), counts, progress);
  progress.report("repairing", 0.7);
  const int parts = orient_outwards(soup, counts);
  if (parts == 0) refuse("it encloses no volume");
  if (!is_closed_manifold(soup)) refuse("some holes or crossing sheets could not be mended");
  if (counts.any()) warnings.push_back({"repaired", told(counts, parts)});
  Mesh mesh = closed_mesh(soup);
  progress.report("repairing", 1);
  return mesh;
}

bool self_intersects(const Mesh& mesh) { return pmp::does_self_intersect(to_cgal(to_soup(mesh))); }

}  // namespace packmerger
