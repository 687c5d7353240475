// From what a file holds to a closed surface.
#pragma once

#include "base/progress.h"
#include "model/mesh.h"
#include "model/warning.h"

namespace packmerger {

// Welds equal points, drops degenerate and duplicate triangles, orients neighbouring triangles
// alike, separates sheets that touch in an edge or at a vertex, stitches borders, drops loose
// shards, fills holes, and orients pieces outwards (see orient.h for pieces
// inside others), and divides edges on which other edges end. What was changed is told in one
// warning with code "repaired" whose text counts it: open edges, facets without area, edges mended,
// facets removed, turned round and added, holes filled, pieces within matter, and the pieces where
// there are several. What changed the shape is told by "shape_changed" (shape_change.h).
//
// A closed 2-manifold that is oriented outwards passes unchanged: the same points and triangles in
// the same order, no warning.
//
// soup: mm. Returns a closed 2-manifold; it may intersect itself (see self_intersects).
// Throws Error{kBadInput} when no closed surface can be made of it.
Mesh repair(const TriangleSoup& soup, Warnings& warnings, const Progress& progress);

// Whether any two triangles meet other than in the edge or the corner they share.
bool self_intersects(const Mesh& mesh);

}  // namespace packmerger
