// Divides the shell into many small connected segments of similar volume (paper, section 4).
#pragma once

#include <cstdint>

#include "base/progress.h"
#include "model/printer.h"
#include "model/segments.h"
#include "model/tet_mesh.h"

namespace packmerger {

// Seeding, then clustering, on the dual graph of the tetrahedra (nodes are centroids, edges cross
// shared faces and are as long as the Euclidean distance of the two centroids):
//   1. seeds are placed one after the other in random unassigned tetrahedra and grown to
//      1/settings.clusters of V_o each, until nowhere is room for another; a component of the mesh
//      too small for any seed gets one all the same;
//   2. all clusters grow at once, nearest tetrahedron first, and are re-grown from the tetrahedra
//      nearest their centres of mass until no centre moves settings.cluster_epsilon_mm or more, or
//      for settings.cluster_rounds rounds;
//   3. every part is made a closed 2-manifold (make_manifold), for which tetrahedra of `mesh` may
//   be
//      split.
// Every segment is face-connected, no label is empty. The number of segments is near
// settings.clusters, usually below it: seeding leaves pockets. Same mesh and seed, same answer.
// Throws Error{kBadInput} when the mesh holds no tetrahedron, kInterrupted.
Segments segment(TetMesh& mesh, const ShapeSettings& settings, std::uint64_t seed,
                 const Progress& progress);

}  // namespace packmerger
