#include "shape/outer_hull.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <map>
#include <vector>

#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/corefinement.h>
#include <CGAL/Surface_mesh.h>

#include "base/error.h"
#include "base/parallel.h"
#include "shape/repair.h"
#include "shape/soup.h"
#include "shape/surface_query.h"

namespace packmerger {
namespace {

using Kernel = CGAL::Exact_predicates_exact_constructions_kernel;
using CgalMesh = CGAL::Surface_mesh<Kernel::Point_3>;

// How far from a piece its two sides are looked at, of the piece's size.
constexpr double kAside = 1e-4;

CgalMesh to_cgal(const Mesh& mesh) {
  CgalMesh result;
  using Index = CgalMesh::Vertex_index;
  const auto index = [](int i) { return Index(static_cast<Index::size_type>(i)); };
  const TriangleSoup soup = to_soup(mesh);
  for (const Vec3& p : soup.points) result.add_vertex({p.x(), p.y(), p.z()});
  for (const auto& [a, b, c] : soup.triangles) result.add_face(index(a), index(b), index(c));
  return result;
}

TriangleSoup cut_pieces(const Mesh& mesh) {
  CgalMesh cut = to_cgal(mesh);
  CGAL::Polygon_mesh_processing::experimental::autorefine(cut);
  TriangleSoup soup;
  std::vector<int> number(cut.num_vertices() + cut.number_of_removed_vertices(), -1);
  for (const auto vertex : cut.vertices()) {
    number[vertex.idx()] = static_cast<int>(soup.points.size());
    const Kernel::Point_3& p = cut.point(vertex);
    soup.points.emplace_back(CGAL::to_double(p.x()), CGAL::to_double(p.y()),
                             CGAL::to_double(p.z()));
  }
  for (const auto face : cut.faces()) {
    std::array<int, 3> triangle{};
    int i = 0;
    for (const auto vertex : cut.vertices_around_face(cut.halfedge(face)))
      triangle[i++] = number[vertex.idx()];
    soup.triangles.push_back(triangle);
  }
  return soup;
}

// The pieces with nothing before them and matter behind.
TriangleSoup outside_of(const TriangleSoup& pieces, const SurfaceQuery& model) {
  std::vector<char> keep(pieces.triangles.size(), 0);
  parallel_for(pieces.triangles.size(), [&](std::size_t i) {
    const auto& [a, b, c] = pieces.triangles[i];
    const Vec3& pa = pieces.points[a];
    const Vec3& pb = pieces.points[b];
    const Vec3& pc = pieces.points[c];
    const Vec3 normal = (pb - pa).cross(pc - pa);
    const double twice_area = normal.norm();
    if (!(twice_area > 0)) return;
    const Vec3 aside = normal * (kAside / std::sqrt(twice_area));
    const Vec3 middle = (pa + pb + pc) / 3;
    const bool before = model.winding_number(middle + aside) != 0;
    const bool behind = model.winding_number(middle - aside) != 0;
    keep[i] = !before && behind ? 1 : 0;
  });
  TriangleSoup kept;
  kept.points = pieces.points;
  for (std::size_t i = 0; i < keep.size(); ++i)
    if (keep[i] != 0) kept.triangles.push_back(pieces.triangles[i]);
  return kept;
}

// Points at the same place belong to sheets that touch; each goes towards its own neighbours.
void draw_apart(Mesh& mesh, double gap_mm) {
  const auto less = [](const Vec3& a, const Vec3& b) {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
  };
  std::map<Vec3, std::vector<Mesh::VertexHandle>, decltype(less)> at(less);
  for (const auto vertex : mesh.vertices()) at[mesh.point(vertex)].push_back(vertex);
  for (const auto& [place, vertices] : at) {
    if (vertices.size() == 1) continue;
    for (const auto vertex : vertices) {
      Vec3 towards = Vec3::Zero();
      for (const auto neighbour : mesh.vv_range(vertex))
        towards += (mesh.point(neighbour) - place).normalized();
      if (towards.norm() > 0) mesh.set_point(vertex, place + gap_mm * towards.normalized());
    }
  }
}

}  // namespace

std::optional<Mesh> outer_hull(const Mesh& mesh, double gap_mm, const Progress& progress) {
  try {
    const TriangleSoup pieces = cut_pieces(mesh);
    progress.check();
    const TriangleSoup outside = outside_of(pieces, SurfaceQuery(mesh));
    Warnings of_pieces;  // what closing the pieces took concerns nobody: the deviation is measured
    Mesh hull = repair(outside, of_pieces, progress);
    draw_apart(hull, gap_mm);
    return hull;
  } catch (const Error& error) {
    if (error.fault() == Fault::kInterrupted) throw;
    return std::nullopt;
  } catch (const std::exception&) {  // CGAL's failures and its triple_intersection exception
    return std::nullopt;
  }
}

}  // namespace packmerger
