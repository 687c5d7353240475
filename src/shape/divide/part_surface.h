// The closed surface of a part.
#pragma once

#include <vector>

#include "model/segments.h"
#include "model/tet_mesh.h"

namespace packmerger {

// The boundary of all tetrahedra with this label: closed, 2-manifold, outward, no two vertices at
// one position, and the volume of its tetrahedra. Throws Error{kInternal} when the boundary is not
// all of that (make_manifold was not called), or the label has no tetrahedron.
SegmentSurface part_surface(const TetMesh& mesh, const Segments& segments, int label);

// All of them, by label, in parallel.
std::vector<SegmentSurface> part_surfaces(const TetMesh& mesh, const Segments& segments);

}  // namespace packmerger
