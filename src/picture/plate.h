// The plate, its grid, the build volume and the camera of this folder's pictures. For this folder
// only.
#pragma once

#include <vector>

#include "offscreen/offscreen.h"

namespace packmerger {

// Adds a plate that covers the box's footprint, its upper side at z = 0, with a line every 10 mm
// and a stronger one every 50 mm (every 1 and 5 mm where the box is smaller than 50 mm).
void add_plate(Scene& scene, const Box3& box);

// Adds the twelve edges of the box.
void add_volume(Scene& scene, const Box3& box);

// Adds a mesh and the shadow it throws on z = 0, as far as the shadow falls on the plate.
void add_standing(Scene& scene, const Mesh& mesh, const Pose& pose, const Colour& colour,
                  const Box3& plate);

// Looks along `direction` at all the boxes, which just fit the image, from so far away that things
// beside each other look equally large. direction: not vertical.
Camera distant_camera(const std::vector<Box3>& boxes, const Vec3& direction, int width, int height);

}  // namespace packmerger
