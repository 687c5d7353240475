// A stand-in for a surface that cannot be used as it is.
#pragma once

#include "base/progress.h"
#include "model/mesh.h"

namespace packmerger {

struct Resampled {
  Mesh surface;
  double deviation_mm = 0;  // measured, two-sided: between surface and the model's outside
};

// A closed, manifold surface that does not intersect itself, around everything the model encloses
// (its winding number is not zero). First the model's own triangles are cut where they cross and
// the outer pieces kept, which changes next to nothing; where that fails a level of a distance grid
// is taken, its points moved back to the model, and the grid made finer until the measured
// deviation is at most tolerance_mm.
//
// The deviation is the largest distance found from the new surface to the model and from the
// outside of the model to the new surface, at points spread over both no further apart than
// tolerance_mm or a hundredth of the model's size, whichever is larger. Folds and crevices thinner
// than half of tolerance_mm do not count.
//
// mesh: closed, mm; it may intersect itself. tolerance_mm > 0.
// Throws Error{kBadInput} when the tolerance is not reached with at most 60 million voxels.
Resampled resample(const Mesh& mesh, double tolerance_mm, const Progress& progress);

// The same by the distance grid alone: for surfaces that do not cross themselves and still cannot
// be used, whose own triangles would not help.
Resampled resample_on_grid(const Mesh& mesh, double tolerance_mm, const Progress& progress);

}  // namespace packmerger
