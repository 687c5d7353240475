#include "shape/divide/boundary_surface.h"

#include <algorithm>
#include <tuple>
#include <utility>

#include "base/error.h"

namespace packmerger {

BoundarySurface boundary_surface(const TetMesh& mesh) {
  BoundarySurface surface;
  struct Side {
    int low, high;  // the edge's ends
    int face;
    int edge;
  };
  std::vector<Side> sides;
  for (int t = 0; t < mesh.count(); ++t)
    for (int f = 0; f < 4; ++f) {
      if (mesh.neighbours[t][f] >= 0) continue;
      const std::array<int, 3> corners = face_corners(mesh, t, f);
      const int face = static_cast<int>(surface.faces.size());
      surface.faces.push_back({corners, {-1, -1, -1}, t, f, mesh.sides[t][f]});
      for (int i = 0; i < 3; ++i) {
        const auto [low, high] = std::minmax(corners[i], corners[(i + 1) % 3]);
        sides.push_back({low, high, face, i});
      }
    }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return std::tie(a.low, a.high, a.face) < std::tie(b.low, b.high, b.face);
  });
  const auto same = [](const Side& a, const Side& b) { return a.low == b.low && a.high == b.high; };
  for (std::size_t i = 0; i < sides.size(); i += 2) {
    if (i + 1 >= sides.size() || !same(sides[i], sides[i + 1]) ||
        (i + 2 < sides.size() && same(sides[i], sides[i + 2])))
      throw Error(Fault::kInternal,
                  "The surface of the tetrahedral mesh is not a closed 2-manifold",
                  "Please report this model to the PackMerger project.");
    surface.faces[sides[i].face].across[sides[i].edge] = sides[i + 1].face;
    surface.faces[sides[i + 1].face].across[sides[i + 1].edge] = sides[i].face;
  }
  return surface;
}

std::vector<std::vector<int>> cavity_faces(const BoundarySurface& surface) {
  std::vector<std::vector<int>> cavities;
  std::vector<char> seen(surface.faces.size(), 0);
  for (int start = 0; start < static_cast<int>(surface.faces.size()); ++start) {
    if (surface.faces[start].side != FaceSide::kCavity || std::exchange(seen[start], 1)) continue;
    std::vector<int> found{start};
    for (std::size_t i = 0; i < found.size(); ++i)
      for (const int across : surface.faces[found[i]].across)
        if (!std::exchange(seen[across], 1)) found.push_back(across);
    cavities.push_back(std::move(found));
  }
  return cavities;
}

double face_area_mm2(const TetMesh& mesh, int tetrahedron, int face) {
  const auto [a, b, c] = face_corners(mesh, tetrahedron, face);
  return (mesh.points[b] - mesh.points[a]).cross(mesh.points[c] - mesh.points[a]).norm() / 2;
}

}  // namespace packmerger
