// Normals that are smooth across blunt edges and sharp at others. For this folder only.
#pragma once

#include <array>
#include <vector>

#include "model/mesh.h"

namespace packmerger {

// A surface whose vertices are split wherever a sharp edge (40° and more) meets them.
struct SplitSurface {
  std::vector<Vec3> points;   // mm
  std::vector<Vec3> normals;  // unit length, one for each point
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

SplitSurface split_at_sharp_edges(const Mesh& mesh);

}  // namespace packmerger
