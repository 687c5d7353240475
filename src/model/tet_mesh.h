// The shell as a tetrahedral cell complex (paper, sections 3 and 4).
#pragma once

#include <array>
#include <vector>

#include "base/geometry.h"

namespace packmerger {

// What lies on the other side of a tetrahedron's face.
enum class FaceSide : signed char {
  kInterior = 0,  // another tetrahedron
  kOutside = 1,   // the face is part of the model's outer surface
  kCavity = 2     // the face is part of a hollowed cavity's surface
};

// Face i of a tetrahedron is the one opposite its corner i. Tetrahedra are positively oriented:
// (b-a) × (c-a) · (d-a) > 0. Every face is shared by exactly two tetrahedra or lies on the
// boundary.
struct TetMesh {
  std::vector<Vec3> points;                    // mm, model coordinates
  std::vector<std::array<int, 4>> tetrahedra;  // indices into points
  std::vector<std::array<int, 4>> neighbours;  // across face i; -1 on the boundary
  std::vector<std::array<FaceSide, 4>> sides;  // of face i

  int count() const { return static_cast<int>(tetrahedra.size()); }
  double volume_mm3(int tetrahedron) const;
  Vec3 centroid(int tetrahedron) const;
};

// The corners (indices into points) of face i of tetrahedron t, counter-clockwise seen from outside
// the tetrahedron.
std::array<int, 3> face_corners(const TetMesh& mesh, int tetrahedron, int face);

// Fills mesh.neighbours from mesh.tetrahedra. Faces without a partner get -1; sides of faces that
// have one become kInterior, the others are left as they are.
void link_neighbours(TetMesh& mesh);

double total_volume_mm3(const TetMesh& mesh);

}  // namespace packmerger
