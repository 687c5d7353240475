// The plate, its grid, the build volume and the camera of this folder's pictures. For this folder
// only.
#pragma once

#include <vector>

#include "model/plate.h"
#include "offscreen/offscreen.h"

namespace packmerger {

// What parts stand on: the footprint of a volume, or a polygon within it.
class Ground {
 public:
  // plate: its walls, counted from the volume's lowest corner.
  explicit Ground(const Box3& volume, const Plate& plate = {});

  const Box3& volume() const { return volume_; }
  const Polygon& outline() const { return outline_; }             // convex
  const std::vector<Polygon>& barred() const { return barred_; }  // where no part may stand
  double size() const { return volume_.sizes().head<2>().maxCoeff(); }

 private:
  Box3 volume_;
  Polygon outline_;
  std::vector<Polygon> barred_;
};

// Adds the plate, its upper side at z = 0, with a line every 10 mm and a stronger one every 50 mm
// (every 1 and 5 mm where it is smaller than 50 mm); what is barred is hatched.
void add_plate(Scene& scene, const Ground& ground);

// Adds the edges of the volume above the plate.
void add_volume(Scene& scene, const Ground& ground);

// Adds a mesh and the shadow it throws on z = 0, as far as the shadow falls on the plate.
void add_standing(Scene& scene, const Mesh& mesh, const Pose& pose, const Colour& colour,
                  const Ground& ground);

// Looks along `direction` at all the boxes, which just fit the image, from so far away that things
// beside each other look equally large. direction: not vertical.
Camera distant_camera(const std::vector<Box3>& boxes, const Vec3& direction, int width, int height);

}  // namespace packmerger
