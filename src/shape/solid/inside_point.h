// A point well inside a closed surface, as TetGen wants one for every hole.
#pragma once

#include "model/mesh.h"

namespace packmerger {

// soup: closed, one component, normals pointing away from the enclosed space. The point is the
// middle of the longest of some chords that start on the surface.
// Throws Error{kBadInput} when no chord lies inside (the surface encloses nothing).
Vec3 point_inside(const TriangleView& soup);

}  // namespace packmerger
