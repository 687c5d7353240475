#include "picture/corner_normals.h"

#include <cmath>

#include "model/half_edges.h"

namespace packmerger {
namespace {

const double kSharpCosine = std::cos(radians(40));

Vec3 area_normal(const Mesh& mesh, std::size_t triangle) {
  const auto [a, b, c] = mesh.corners(triangle);
  return (b - a).cross(c - a);
}

// The sum over the faces around the vertex that turn less than the limit against this one.
Vec3 corner_normal(const std::vector<Vec3>& around, const Vec3& own) {
  if (own.norm() <= 0) return Vec3::UnitZ();  // a face without area shows nothing anyway
  Vec3 sum = Vec3::Zero();
  for (const Vec3& other : around)
    if (own.dot(other) >= kSharpCosine * own.norm() * other.norm()) sum += other;
  const double length = sum.norm();
  return length > 0 ? Vec3(sum / length) : Vec3(own.normalized());
}

}  // namespace

SplitSurface split_at_sharp_edges(const Mesh& mesh) {
  std::vector<Vec3> face_normals(mesh.n_triangles());
  for (std::size_t i = 0; i < face_normals.size(); ++i) face_normals[i] = area_normal(mesh, i);

  SplitSurface result;
  result.triangles.resize(mesh.n_triangles());
  const HalfEdges edges = half_edges(mesh);
  for (const auto vertex : edges.vertices()) {
    std::vector<Vec3> around;
    for (const auto face : vertex.faces()) around.push_back(face_normals[face.idx()]);
    const std::size_t first = result.points.size();
    for (const auto face : vertex.faces()) {
      const Vec3 normal = corner_normal(around, face_normals[face.idx()]);
      std::size_t point = first;
      while (point < result.points.size() && result.normals[point].dot(normal) < 1 - 1e-6) ++point;
      if (point == result.points.size()) {
        result.points.push_back(mesh.points()[vertex.idx()]);
        result.normals.push_back(normal);
      }
      for (std::size_t k = 0; k < 3; ++k)
        if (mesh.triangles()[face.idx()][k] == vertex.idx())
          result.triangles[face.idx()][k] = static_cast<std::uint32_t>(point);
    }
  }
  return result;
}

}  // namespace packmerger
