// The last word on taking a tray apart: on the meshes themselves, nothing of the grid.
#pragma once

#include <optional>
#include <vector>

#include "base/progress.h"
#include "model/mesh.h"

namespace packmerger {

struct Obstacle {
  int taken = 0;  // index of the part that does not come out
  int by = 0;     // of the part that is in its way
};

// Takes the parts out in the order given, each along its path, if it has one, and then straight up:
// the first that meets another, if any. Lifting is decided exactly, facet by facet: what overlaps
// by less than 0.001 mm, seen from above, touches. Along paths parts must stay 0.02 mm apart.
// parts: closed, where they stand on one tray, mm. order: some of their indices, each once; what it
// does not list is not there. paths: by part, or empty.
std::optional<Obstacle> first_obstacle(const std::vector<Mesh>& parts,
                                       const std::vector<int>& order,
                                       const std::vector<std::vector<Vec3>>& paths,
                                       const Progress& progress);

}  // namespace packmerger
