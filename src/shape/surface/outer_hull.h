// The outside of a surface that crosses itself, exactly.
#pragma once

#include <optional>

#include "base/progress.h"
#include "model/mesh.h"

namespace packmerger {

// Cuts the triangles along the curves in which they cross (cut_crossings.h), and keeps the pieces
// that separate what the surface winds around from what it does not. Points off those curves stay
// where they are; those on them are rounded to doubles. The result is made closed and manifold
// again; where sheets touch in a point or an edge they are drawn apart by about gap_mm. It may
// cross itself anew where its pieces are as small as that.
// mesh: closed. Nullopt where too much crosses or the pieces do not close: an ordinary outcome.
// Throws Error{kInterrupted}.
std::optional<Mesh> outer_hull(const Mesh& mesh, double gap_mm, const Progress& progress);

}  // namespace packmerger
