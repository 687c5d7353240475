// Questions about where a point lies with respect to a surface, answered by a CGAL AABB tree.
#pragma once

#include <memory>
#include <optional>

#include "model/mesh.h"

namespace packmerger {

// Copies what it needs; const members may be called from any thread.
class SurfaceQuery {
 public:
  // surface: at least one triangle; need be neither closed nor manifold.
  explicit SurfaceQuery(const TriangleView& surface);
  SurfaceQuery(SurfaceQuery&&) noexcept;
  SurfaceQuery& operator=(SurfaceQuery&&) noexcept;
  ~SurfaceQuery();

  struct Nearest {
    Vec3 point;    // on the surface
    int triangle;  // the face's index, as in the soup or the mesh
    double distance_mm;
  };
  Nearest nearest(const Vec3& point) const;

  double distance_mm(const Vec3& point) const { return nearest(point).distance_mm; }

  // How many times the surface winds around the point: of a closed surface 0 outside, 1 in the
  // matter, 0 in its cavities; 2 and more where components overlap. Undefined on the surface.
  int winding_number(const Vec3& point) const;

  // Distance along a unit direction to the first triangle further away than 1e-9 mm.
  std::optional<double> ray_mm(const Vec3& from, const Vec3& direction) const;

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

}  // namespace packmerger
