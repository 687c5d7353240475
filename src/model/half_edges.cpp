#include "model/half_edges.h"

#include <vector>

#include "base/error.h"

namespace packmerger {

void refuse_surface(const std::string& why) {
  throw Error(Fault::kBadInput, "The surface is not a closed 2-manifold: " + why,
              "Repair the model in a mesh editor and try again.");
}

HalfEdges half_edges(const TriangleView& surface) {
  HalfEdges edges;
  edges.reserve(surface.points.size(), surface.triangles.size() * 3 / 2, surface.triangles.size());
  for (std::size_t i = 0; i < surface.points.size(); ++i) edges.add_vertex();

  // OpenMesh writes to stderr when it must refuse a face, so what it would refuse is found first
  // by is_boundary tests: each corner needs a gap, each directed edge must be free.
  std::vector<HalfEdges::VertexHandle> corner(3);
  for (const std::array<int, 3>& triangle : surface.triangles) {
    for (std::size_t i = 0; i < 3; ++i) corner[i] = HalfEdges::VertexHandle(triangle[i]);
    if (triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0])
      refuse_surface("a triangle has a corner twice");
    for (std::size_t i = 0; i < 3; ++i) {
      if (!edges.is_boundary(corner[i])) refuse_surface("two sheets touch at a vertex");
      const auto edge = edges.find_halfedge(corner[i], corner[(i + 1) % 3]);
      if (edge.is_valid() && !edges.is_boundary(edge))
        refuse_surface("an edge has more than two sides");
    }
    if (!edges.add_face(corner).is_valid()) refuse_surface("two sheets touch at a vertex");
  }
  return edges;
}

}  // namespace packmerger
