// A surface cut along the curves in which it crosses or touches itself.
#pragma once

#include <optional>

#include "base/progress.h"
#include "model/mesh.h"

namespace packmerger {

// Pieces that cover the surface and meet in nothing but whole edges and corners, turned as the
// triangles they were cut from. Where triangles lie on one another in one plane their common pieces
// are there once, turned as one of them. Triangles that nothing crosses are kept as they are, as
// are all their corners; points where triangles cross are exact and then rounded to doubles, so
// that very small pieces may cross or collapse again; those that collapse are left out.
// mesh: closed. Nullopt where so many triangles cross one another that it would take minutes.
std::optional<TriangleSoup> cut_at_crossings(const Mesh& mesh, const Progress& progress);

}  // namespace packmerger
