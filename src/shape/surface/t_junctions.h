// Points of a surface that lie on an edge of it without dividing the edge, as CSG programs write
// them. Used by repair.
#pragma once

#include "base/progress.h"
#include "model/mesh.h"

namespace packmerger {

// Divides the triangles along an open edge on which other open edges end, at every point that is
// nearer to the edge than tolerance_mm; a chain of such points at once. No point moves. soup:
// welded within that tolerance. Returns how many edges were divided. Throws Error{kInterrupted}.
int divide_at_t_junctions(TriangleSoup& soup, double tolerance_mm, const Progress& progress);

}  // namespace packmerger
