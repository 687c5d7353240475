// The surface of a tetrahedral mesh as triangles that know their neighbours. Internal to this
// folder.
#pragma once

#include <array>
#include <vector>

#include "model/tet_mesh.h"

namespace packmerger {

struct BoundarySurface {
  struct Face {
    std::array<int, 3> corners;  // indices into TetMesh::points, counter-clockwise from outside
    std::array<int, 3> across;   // the face over the edge from corner i to corner i + 1
    int tetrahedron;
    int face;  // of the tetrahedron
    FaceSide side;
  };
  std::vector<Face> faces;  // by tetrahedron, then face
};

// Throws Error{kInternal} when an edge of the boundary has not exactly two faces.
BoundarySurface boundary_surface(const TetMesh& mesh);

// The faces of each hollowed cavity, as indices into surface.faces; cavities by their first face.
std::vector<std::vector<int>> cavity_faces(const BoundarySurface& surface);

double face_area_mm2(const TetMesh& mesh, int tetrahedron, int face);

}  // namespace packmerger
