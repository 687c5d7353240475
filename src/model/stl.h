// Writing surfaces as binary STL (3D Systems, 1989). Used for the job folder, and for what a
// slicer is given.
#pragma once

#include <string>
#include <vector>

#include "model/mesh.h"

namespace packmerger {

// The points of several closed surfaces, rounded to 32-bit floats in such a way that no two of them
// become equal: where rounding would weld two, the later one is moved by a few units in the last
// place (below 1e-6 of the largest coordinate). So a reader that finds the topology by equal
// positions, as every STL reader must, finds the same closed 2-manifolds. A coordinate less than a
// millionth of a mm below zero becomes zero. Point i of mesh m is at [m][i].
// Throws Error{kBadInput} when a coordinate is not finite or beyond 1e9 mm.
std::vector<std::vector<Eigen::Vector3f>> float_points(const std::vector<const Mesh*>& meshes);

// One binary STL of all the surfaces, mm, with normals. Errors as float_points().
std::string binary_stl(const std::vector<const Mesh*>& meshes);

}  // namespace packmerger
