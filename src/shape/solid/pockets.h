// Where a model holds what does not come out of it: loose powder, above all.
#pragma once

#include <cstddef>

#include "base/progress.h"
#include "model/mesh.h"

namespace packmerger {

// Cavities without any way out: components of the surface that are oriented inwards.
// mesh: closed, normals out of matter.
std::size_t sealed_cavities(const Mesh& mesh);

// Those; pockets that a ball as wide as an opening should be has room in and cannot leave; and
// chambers that have one way out for it alone, and none that is 1.8 times as wide. To within half a
// millimetre, or a little more where the model is large. Throws Error{kInterrupted}.
std::size_t keeping_cavities(const Mesh& mesh, double opening_mm, const Progress& progress);

}  // namespace packmerger
