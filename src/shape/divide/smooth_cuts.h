// Smooths the jagged cuts between segments (paper, section 5: Laplacian smoothing of each segment's
// boundary).
#pragma once

#include "base/progress.h"
#include "model/printer.h"
#include "model/segments.h"
#include "model/tet_mesh.h"

namespace packmerger {

// Mean turning angle, radians, of the cut curves on the outer and cavity surfaces: over all points
// where exactly two cut edges meet, the angle between the one's direction and the other's.
double cut_roughness(const TetMesh& mesh, const Segments& segments);

struct CutRoughness {
  double before_rad = 0;
  double after_rad = 0;
};

// First the teeth of the cuts are re-assigned: tetrahedra whose change of segment makes the cuts
// smaller, pinches no part and lets no two segments touch that did not. Then points of `mesh` that
// lie on cuts are moved towards the average of their neighbours on the same cut,
// settings.smooth_rounds times: along junction curves where three segments meet, along the cut
// curves on the outer and cavity surfaces, and over the cut surfaces between. Both sides of a cut
// share the points, so parts still fit.
//   - a point of the outer or a cavity surface stays on that surface as it was at the start; on a
//     sharp edge of the outer surface (40° or more) it moves along the edge; corners and ends of
//     sharp edges stay;
//   - the surface as triangulated afterwards lies within 0.1 mm of what it was, and the reverse;
//   - the whole volume changes by at most 0.05 %;
//   - no tetrahedron inverts: a step is halved, then given up, rather than leave one below a tenth
//   of
//     its volume at the start.
// The mesh's topology stays. Parts that were manifold stay manifold and connected; cross-sections
// become smaller as they become straight (premerge again where they must not). Deterministic.
// Throws Error{kInterrupted}.
CutRoughness smooth_cuts(TetMesh& mesh, Segments& segments, const ShapeSettings& settings,
                         const Progress& progress);

}  // namespace packmerger
