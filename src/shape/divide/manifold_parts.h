// Makes every part of a division printable by itself: the boundary of each is a closed 2-manifold.
#pragma once

#include <limits>

#include "base/progress.h"
#include "model/segments.h"
#include "model/tet_mesh.h"

namespace packmerger {

struct ManifoldChange {
  int reassigned = 0;  // tetrahedra that changed their segment whole
  int split = 0;       // tetrahedra that were cut up around an edge or a vertex
};

// How far a part may grow where parts have their places on a tray already. Well below any gap
// between parts, well above the resolution of the float coordinates of STL.
inline constexpr double kPlacedReach_mm = 0.1;
inline constexpr double kFreeReach = std::numeric_limits<double>::infinity();

// A part is pinched where it touches itself along an edge or in a vertex only. First whole
// tetrahedra are re-assigned where that removes pinches and makes no new one; what is left is
// removed by cutting a small spindle around each pinched edge, then a small ball around each
// pinched vertex, out of all parts that meet there and giving it to one of them. That ends after
// one pass: a spindle or a ball leaves no pinch in its star and makes none elsewhere.
//
// In: the mesh's own boundary is a closed 2-manifold and every label is face-connected.
// Out: every part's boundary is a closed 2-manifold with equal positions welded, every part is
// face-connected, the mesh still conforms and fills the same space (points of the outer and cavity
// surfaces stay, new ones lie on them). No part gains a point further than reach_mm away from where
// it was: with kPlacedReach_mm only tetrahedra smaller than that are re-assigned, so this is the
// call after packing. Deterministic. Throws Error{kInternal} when the mesh breaks the conditions
// above.
ManifoldChange make_manifold(TetMesh& mesh, Segments& segments, const Progress& progress,
                             double reach_mm = kPlacedReach_mm);

// True when no part is pinched.
bool is_manifold(const TetMesh& mesh, const Segments& segments);

}  // namespace packmerger
