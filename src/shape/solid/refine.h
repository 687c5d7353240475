// Splitting what is too large, by bisection of edges, the longest first (Rivara, 1984): no shape
// changes, every neighbour follows.
#pragma once

#include <vector>

#include "model/mesh.h"
#include "model/tet_mesh.h"

namespace packmerger {

// Halves edges longer than max_edge_mm, longest first, until none is left. The points there were
// keep their numbers; a triangle's pieces inherit its marker.
// soup: closed, manifold. markers: one per triangle.
void split_long_edges(TriangleSoup& soup, std::vector<int>& markers, double max_edge_mm);

// Halves edges of tetrahedra that hold more than max_volume_mm3 until none does; of each the
// longest edge, unless a neighbour around it has a longer one (longest-edge propagation, Rivara),
// so shapes do not degrade. The points there were keep their numbers; neighbours and sides are kept
// true.
void split_large_tetrahedra(TetMesh& mesh, double max_volume_mm3);

}  // namespace packmerger
