// The half-edge structure of a surface (OpenMesh), for the check that it is a 2-manifold and for
// going round a point. Others read Mesh::triangles() and neighbours() and need not compile it.
#pragma once

#include <string>

#include <OpenMesh/Core/Mesh/TriConnectivity.hh>

#include "model/mesh.h"

namespace packmerger {

// Vertex i is point i, face i triangle i; points and what they are worth stay where they are.
using HalfEdges = OpenMesh::TriConnectivity;

// Throws Error{kBadInput} when a triangle cannot be held by a 2-manifold (OpenMesh itself would
// drop it with only a line on stderr). The surface may have borders.
HalfEdges half_edges(const TriangleView& surface);

// The Error{kBadInput} of a surface that is not a closed 2-manifold.
[[noreturn]] void refuse_surface(const std::string& why);

}  // namespace packmerger
