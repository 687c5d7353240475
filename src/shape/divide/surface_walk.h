// The surface of a tetrahedral mesh as it was, and the way over it. Internal to this folder.
#pragma once

#include <span>
#include <vector>

#include "shape/divide/boundary_surface.h"

namespace packmerger {

Vec3 nearest_on_triangle(const Vec3& point, const Vec3& a, const Vec3& b, const Vec3& c);

// Where a boundary point may go.
enum class Freedom : signed char {
  kNone = 0,    // a corner, the end of a sharp edge, or not on the surface at all
  kCrease = 1,  // along sharp edges
  kFace = 2     // over the surface
};

// Keeps a copy of the points.
class SurfaceWalk {
 public:
  // Edges of the outside that bend by more than crease_angle (radians) are sharp; where two meet
  // that turn by more than that is a corner.
  SurfaceWalk(const TetMesh& mesh, double crease_angle);

  const BoundarySurface& surface() const { return surface_; }
  const Vec3& home(int point) const { return points_[point]; }
  Freedom freedom(int point) const { return freedom_[point]; }
  // The faces that contain the point; empty inside the mesh.
  std::span<const int> faces_at(int point) const;
  Vec3 normal(int face) const;

  struct Place {
    Vec3 point;
    int face = -1;
  };
  // The nearest point of the surface downhill from `from` (a face): the nearest of all as long as
  // the target is near that face.
  Place nearest(const Vec3& target, int from) const;

  // The nearest point on the two sharp edges at a point whose freedom is kCrease.
  Vec3 nearest_on_crease(const Vec3& target, int point) const;

 private:
  void find_creases(double crease_angle);
  Vec3 nearest_in_face(const Vec3& target, int face) const;

  std::vector<Vec3> points_;
  BoundarySurface surface_;
  std::vector<int> first_face_;  // compressed rows by point
  std::vector<int> faces_;
  std::vector<Freedom> freedom_;
  std::vector<std::array<int, 2>> crease_ends_;  // the two neighbours along the crease, or -1
};

}  // namespace packmerger
