// Surfaces. Mesh is the half-edge mesh of the house (OpenMesh); TriangleSoup is what files hold
// before anyone has looked whether it is a surface at all.
#pragma once

#include <array>
#include <vector>

#include "base/geometry.h"

// EigenVectorT.hh specialises what the kernel declares, so it comes second.
// clang-format off
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Core/Geometry/EigenVectorT.hh>
// clang-format on

namespace packmerger {

struct MeshTraits : OpenMesh::DefaultTraits {
  using Point = Vec3;   // mm
  using Normal = Vec3;  // unit length
};

// Everywhere but in the inside of a verb a Mesh is closed, 2-manifold, and its normals point out of
// the matter; it may have several components, and inner ones (cavities) are oriented towards the
// empty side. No two vertices hold the same position.
using Mesh = OpenMesh::TriMesh_ArrayKernelT<MeshTraits>;

struct TriangleSoup {
  std::vector<Vec3> points;                   // mm, or the file's unit where a header says so
  std::vector<std::array<int, 3>> triangles;  // indices into points, counter-clockwise from outside
};

// The corners of one face, counter-clockwise seen from outside.
std::array<Vec3, 3> corners(const Mesh& mesh, Mesh::FaceHandle face);

// Builds the half-edge mesh. Throws Error{kBadInput} when a triangle cannot be held by a 2-manifold
// (OpenMesh itself would drop it with only a line on stderr) or an edge has one side only.
Mesh closed_mesh(const TriangleSoup& soup);

TriangleSoup to_soup(const Mesh& mesh);

// Signed: cavities count negative. mm³.
double volume_mm3(const Mesh& mesh);
double area_mm2(const Mesh& mesh);
Box3 bounding_box(const Mesh& mesh);

// A copy with every point p at pose * p.
Mesh transformed(const Mesh& mesh, const Pose& pose);

// The disjoint union of several meshes, without any boolean operation.
Mesh united(const std::vector<const Mesh*>& meshes);

}  // namespace packmerger
