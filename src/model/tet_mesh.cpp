#include "model/tet_mesh.h"

#include <algorithm>
#include <tuple>

namespace packmerger {

double TetMesh::volume_mm3(int tetrahedron) const {
  const auto [a, b, c, d] = tetrahedra[tetrahedron];
  return (points[b] - points[a]).cross(points[c] - points[a]).dot(points[d] - points[a]) / 6;
}

Vec3 TetMesh::centroid(int tetrahedron) const {
  const auto [a, b, c, d] = tetrahedra[tetrahedron];
  return (points[a] + points[b] + points[c] + points[d]) / 4;
}

std::array<int, 3> face_corners(const TetMesh& mesh, int tetrahedron, int face) {
  static constexpr int kFaces[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
  const std::array<int, 4>& t = mesh.tetrahedra[tetrahedron];
  return {t[kFaces[face][0]], t[kFaces[face][1]], t[kFaces[face][2]]};
}

void link_neighbours(TetMesh& mesh) {
  struct Side {
    std::array<int, 3> key;
    int tetrahedron;
    int face;
  };
  std::vector<Side> all;
  all.reserve(mesh.tetrahedra.size() * 4);
  for (int t = 0; t < mesh.count(); ++t)
    for (int face = 0; face < 4; ++face) {
      std::array<int, 3> key = face_corners(mesh, t, face);
      std::sort(key.begin(), key.end());
      all.push_back({key, t, face});
    }
  std::sort(all.begin(), all.end(), [](const Side& a, const Side& b) {
    return std::tie(a.key, a.tetrahedron) < std::tie(b.key, b.tetrahedron);
  });
  mesh.neighbours.assign(mesh.tetrahedra.size(), {-1, -1, -1, -1});
  mesh.sides.resize(mesh.tetrahedra.size());
  for (std::size_t i = 0; i + 1 < all.size(); ++i) {
    const Side& a = all[i];
    const Side& b = all[i + 1];
    if (a.key != b.key) continue;
    mesh.neighbours[a.tetrahedron][a.face] = b.tetrahedron;
    mesh.neighbours[b.tetrahedron][b.face] = a.tetrahedron;
    mesh.sides[a.tetrahedron][a.face] = FaceSide::kInterior;
    mesh.sides[b.tetrahedron][b.face] = FaceSide::kInterior;
  }
}

double total_volume_mm3(const TetMesh& mesh) {
  double sum = 0;
  for (int t = 0; t < mesh.count(); ++t) sum += mesh.volume_mm3(t);
  return sum;
}

}  // namespace packmerger
