#include "model/mesh.h"

#include <algorithm>
#include <utility>

#include "base/error.h"
#include "model/half_edges.h"

namespace packmerger {
namespace {

// By OpenMesh's half-edges: a face's begin with that from its third corner to its first.
std::vector<std::array<int, 3>> neighbours_in(const HalfEdges& edges) {
  std::vector<std::array<int, 3>> neighbours;
  neighbours.reserve(edges.n_faces());
  for (const auto face : edges.faces()) {
    const auto last = face.halfedge();
    const auto first = last.next();
    neighbours.push_back(
        {first.opp().face().idx(), first.next().opp().face().idx(), last.opp().face().idx()});
  }
  return neighbours;
}

}  // namespace

Mesh::Mesh() {
  static const auto no_points = std::make_shared<const std::vector<Vec3>>();
  static const auto no_faces = std::make_shared<const Faces>();
  points_ = no_points;
  faces_ = no_faces;
}

Mesh::Mesh(std::vector<Vec3> points, Faces faces)
    : points_(std::make_shared<const std::vector<Vec3>>(std::move(points))),
      faces_(std::make_shared<const Faces>(std::move(faces))) {}

Mesh Mesh::with_points(std::vector<Vec3> points) const {
  if (points.size() != n_points())
    throw Error(Fault::kInternal, "A mesh was given another number of points",
                "Please report this as a bug.");
  Mesh mesh;
  mesh.points_ = std::make_shared<const std::vector<Vec3>>(std::move(points));
  mesh.faces_ = faces_;
  return mesh;
}

TriangleSoup without_unused_points(TriangleSoup soup) {
  std::vector<int> number(soup.points.size(), -1);
  for (const auto& triangle : soup.triangles)
    for (const int corner : triangle) number[corner] = 0;
  if (std::find(number.begin(), number.end(), -1) == number.end()) return soup;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < number.size(); ++i) {
    if (number[i] < 0) continue;
    number[i] = static_cast<int>(kept);
    soup.points[kept++] = soup.points[i];
  }
  soup.points.resize(kept);
  for (auto& triangle : soup.triangles)
    for (int& corner : triangle) corner = number[corner];
  return soup;
}

Mesh manifold_mesh(TriangleSoup soup) {
  soup = without_unused_points(std::move(soup));
  Mesh::Faces faces;
  faces.neighbours = neighbours_in(half_edges(soup));
  faces.are_closed =
      std::none_of(faces.neighbours.begin(), faces.neighbours.end(), [](const auto& beside) {
        return std::find(beside.begin(), beside.end(), -1) != beside.end();
      });
  faces.corners = std::move(soup.triangles);
  return Mesh(std::move(soup.points), std::move(faces));
}

Mesh closed_mesh(TriangleSoup soup) {
  Mesh mesh = manifold_mesh(std::move(soup));
  if (!mesh.is_closed()) refuse_surface("it has holes");
  return mesh;
}

TriangleSoup to_soup(const TriangleView& surface) {
  return {{surface.points.begin(), surface.points.end()},
          {surface.triangles.begin(), surface.triangles.end()}};
}

double volume_mm3(const Mesh& mesh) {
  if (mesh.empty()) return 0;
  const Vec3& origin = mesh.points().front();  // near the surface, for precision
  double six_volumes = 0;
  for (std::size_t i = 0; i < mesh.n_triangles(); ++i) {
    const auto [a, b, c] = mesh.corners(i);
    six_volumes += (a - origin).dot((b - origin).cross(c - origin));
  }
  return six_volumes / 6;
}

double area_mm2(const Mesh& mesh) {
  double twice = 0;
  for (std::size_t i = 0; i < mesh.n_triangles(); ++i) {
    const auto [a, b, c] = mesh.corners(i);
    twice += (b - a).cross(c - a).norm();
  }
  return twice / 2;
}

Box3 bounding_box(const Mesh& mesh) {
  Box3 box;
  for (const Vec3& point : mesh.points()) box.extend(point);
  return box;
}

Mesh transformed(const Mesh& mesh, const Pose& pose) {
  std::vector<Vec3> points;
  points.reserve(mesh.n_points());
  for (const Vec3& point : mesh.points()) points.push_back(pose * point);
  return mesh.with_points(std::move(points));
}

Mesh united(const std::vector<const Mesh*>& meshes) {
  if (meshes.size() == 1) return *meshes.front();
  std::vector<Vec3> points;
  Mesh::Faces faces;
  for (const Mesh* mesh : meshes) {
    const int first_point = static_cast<int>(points.size());
    const int first_face = static_cast<int>(faces.corners.size());
    points.insert(points.end(), mesh->points().begin(), mesh->points().end());
    for (const auto& [a, b, c] : mesh->triangles())
      faces.corners.push_back({a + first_point, b + first_point, c + first_point});
    for (std::array<int, 3> beside : mesh->neighbours()) {
      for (int& face : beside)
        if (face >= 0) face += first_face;
      faces.neighbours.push_back(beside);
    }
    faces.are_closed = faces.are_closed && mesh->is_closed();
  }
  return Mesh(std::move(points), std::move(faces));
}

}  // namespace packmerger
