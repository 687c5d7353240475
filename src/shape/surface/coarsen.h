// Fewer triangles for the same shape: edge collapses by quadric error metrics (Garland and
// Heckbert, 1997).
#pragma once

#include "base/progress.h"
#include "model/mesh.h"

namespace packmerger {

// Collapses edges, cheapest quadric error first, as long as the surface stays within about
// tolerance_mm of where it was and no edge grows beyond max_edge_mm. The topology is kept. The
// result may intersect itself in narrow places: check it with self_intersects().
// mesh: closed. Collapsed points end up on one of the points there were.
// Throws Error{kInterrupted}.
Mesh coarsened(const Mesh& mesh, double tolerance_mm, double max_edge_mm, const Progress& progress);

}  // namespace packmerger
