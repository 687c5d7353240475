#include "model/mesh.h"

#include <string>

#include "base/error.h"

namespace packmerger {

std::array<Vec3, 3> corners(const Mesh& mesh, Mesh::FaceHandle face) {
  const auto first = mesh.halfedge_handle(face);
  const auto second = mesh.next_halfedge_handle(first);
  return {mesh.point(mesh.from_vertex_handle(first)), mesh.point(mesh.to_vertex_handle(first)),
          mesh.point(mesh.to_vertex_handle(second))};
}

Mesh closed_mesh(const TriangleSoup& soup) {
  const auto refuse = [](const std::string& why) {
    throw Error(Fault::kBadInput, "The surface is not a closed 2-manifold: " + why,
                "Repair the model in a mesh editor and try again.");
  };
  Mesh mesh;
  mesh.reserve(soup.points.size(), soup.triangles.size() * 3 / 2, soup.triangles.size());
  std::vector<bool> used(soup.points.size(), false);
  for (const std::array<int, 3>& triangle : soup.triangles)
    for (const int corner : triangle) used[corner] = true;
  std::vector<Mesh::VertexHandle> vertices(soup.points.size());
  for (std::size_t i = 0; i < soup.points.size(); ++i)
    if (used[i]) vertices[i] = mesh.add_vertex(soup.points[i]);

  // OpenMesh writes to stderr when it must refuse a face, so what it would refuse is found first
  // by is_boundary tests: each corner needs a gap, each directed edge must be free.
  std::vector<Mesh::VertexHandle> corner(3);
  for (const std::array<int, 3>& triangle : soup.triangles) {
    for (int i = 0; i < 3; ++i) corner[i] = vertices[triangle[i]];
    if (triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0])
      refuse("a triangle has a corner twice");
    for (int i = 0; i < 3; ++i) {
      if (!mesh.is_boundary(corner[i])) refuse("two sheets touch at a vertex");
      const auto edge = mesh.find_halfedge(corner[i], corner[(i + 1) % 3]);
      if (edge.is_valid() && !mesh.is_boundary(edge)) refuse("an edge has more than two sides");
    }
    if (!mesh.add_face(corner).is_valid()) refuse("two sheets touch at a vertex");
  }
  for (const auto edge : mesh.edges())
    if (mesh.is_boundary(edge)) refuse("it has holes");
  return mesh;
}

TriangleSoup to_soup(const Mesh& mesh) {
  TriangleSoup soup;
  soup.points.reserve(mesh.n_vertices());
  soup.triangles.reserve(mesh.n_faces());
  for (const auto vertex : mesh.vertices()) soup.points.push_back(mesh.point(vertex));
  for (const auto face : mesh.faces()) {
    std::array<int, 3> triangle{};
    int i = 0;
    for (const auto vertex : face.vertices_ccw()) triangle[i++] = vertex.idx();
    soup.triangles.push_back(triangle);
  }
  return soup;
}

double volume_mm3(const Mesh& mesh) {
  if (mesh.n_vertices() == 0) return 0;
  const Vec3 origin = mesh.point(Mesh::VertexHandle(0));  // near the surface, for precision
  double six_volumes = 0;
  for (const auto face : mesh.faces()) {
    const auto [a, b, c] = corners(mesh, face);
    six_volumes += (a - origin).dot((b - origin).cross(c - origin));
  }
  return six_volumes / 6;
}

double area_mm2(const Mesh& mesh) {
  double twice = 0;
  for (const auto face : mesh.faces()) {
    const auto [a, b, c] = corners(mesh, face);
    twice += (b - a).cross(c - a).norm();
  }
  return twice / 2;
}

Box3 bounding_box(const Mesh& mesh) {
  Box3 box;
  for (const auto vertex : mesh.vertices()) box.extend(mesh.point(vertex));
  return box;
}

Mesh transformed(const Mesh& mesh, const Pose& pose) {
  Mesh result = mesh;
  for (const auto vertex : result.vertices()) result.set_point(vertex, pose * mesh.point(vertex));
  return result;
}

Mesh united(const std::vector<const Mesh*>& meshes) {
  TriangleSoup all;
  for (const Mesh* mesh : meshes) {
    const int base = static_cast<int>(all.points.size());
    const TriangleSoup one = to_soup(*mesh);
    all.points.insert(all.points.end(), one.points.begin(), one.points.end());
    for (const auto& [a, b, c] : one.triangles)
      all.triangles.push_back({a + base, b + base, c + base});
  }
  return closed_mesh(all);
}

}  // namespace packmerger
