// The last word on taking a tray apart: on the meshes themselves, nothing of the grid.
#pragma once

#include <optional>
#include <vector>

#include "base/progress.h"
#include "model/mesh.h"
#include "pack/exact/sweep.h"

namespace packmerger {

struct Obstacle {
  int taken = 0;  // index of the part that does not come out
  int by = 0;     // of the part that is in its way
};

// Takes the parts out in the order given, each along its path, if it has one, and then straight up:
// the first that meets another, if any. Lifting is decided exactly, facet by facet: what overlaps
// by less than 0.001 mm, seen from above, touches. Along paths parts must stay 0.02 mm apart.
// order: some of their indices, each once; what it does not list is not there. paths: by part, or
// empty.
std::optional<Obstacle> first_obstacle(const StandingParts& parts, const std::vector<int>& order,
                                       const std::vector<std::vector<Vec3>>& paths);

// parts: closed, where they stand on one tray, mm.
std::optional<Obstacle> first_obstacle(const std::vector<Mesh>& parts,
                                       const std::vector<int>& order,
                                       const std::vector<std::vector<Vec3>>& paths,
                                       const Progress& progress);

// Whether a box stays over the base and above the plate where it is moved by so much.
bool is_over_base(const Box3& box, const Vec3& moved, const Vec2& base_mm);

// Whether every part does so along its path; beyond the path it goes straight up.
bool stay_over_base(const StandingParts& parts, const std::vector<std::vector<Vec3>>& paths,
                    const Vec2& base_mm);

}  // namespace packmerger
