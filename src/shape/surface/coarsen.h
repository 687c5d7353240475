// Fewer triangles for the same shape: edge collapses by quadric error metrics (Garland and
// Heckbert, 1997).
#pragma once

#include "base/progress.h"
#include "model/mesh.h"

namespace packmerger {

// Collapses edges no longer than max_edge_mm, cheapest quadric error first, as long as that error
// is one of about tolerance_mm over a patch of that width. It is a mean: single places may lie
// several times as far from where the surface was, and edges grow to about twice max_edge_mm. The
// topology is kept. The result may intersect itself in narrow places, which self_intersects()
// tells.
//
// mesh: closed. Collapsed points end up on one of the points there were. Throws
// Error{kInterrupted}.
Mesh coarsened(const Mesh& mesh, double tolerance_mm, double max_edge_mm, const Progress& progress);

}  // namespace packmerger
