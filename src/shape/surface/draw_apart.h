// Sheets of a surface that touch in an edge or a corner, made to stand apart.
#pragma once

#include "model/mesh.h"

namespace packmerger {

// Where more than two triangles meet at an edge, those that bound the same matter belong together;
// each fan of them gets a point of its own, which goes into its matter by gap_mm, or less where its
// edges are short. Other points stay, as do order and number of the triangles. The result is
// manifold wherever the surface was closed.
// soup: oriented outwards, points that touch have the same number.
TriangleSoup drawn_apart(const TriangleSoup& soup, double gap_mm);

}  // namespace packmerger
