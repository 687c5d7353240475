// Where a model holds what cannot come out of it: loose powder, above all.
#pragma once

#include <cstddef>

#include "base/progress.h"
#include "model/mesh.h"

namespace packmerger {

// Cavities without any way out: components of the surface that are oriented inwards.
// mesh: closed, normals out of matter.
std::size_t sealed_cavities(const Mesh& mesh);

// Those, and pockets that a ball of this diameter has room in and cannot leave: every way out of
// them is narrower, to within half a millimetre, or a little more where the model is large.
// Throws Error{kInterrupted}.
std::size_t pockets(const Mesh& mesh, double ball_mm, const Progress& progress);

}  // namespace packmerger
