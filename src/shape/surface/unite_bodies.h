// Bodies that overlap made one.
#pragma once

#include "base/progress.h"
#include "model/mesh.h"
#include "model/warning.h"

namespace packmerger {

// The surface around everything that mesh winds around, each part of space once, as slicers take
// it. A mesh that does not cross itself, or encloses hardly anything twice, passes unchanged.
// Warnings: "united"; "shape_changed" instead where that changed the volume or the area by more
// than 1 %, or where bodies overlap and cannot be united, and mesh is returned. mesh: as repair()
// returns it, mm. Throws Error{kInterrupted}.
Mesh unite_bodies(Mesh mesh, Warnings& warnings, const Progress& progress);

}  // namespace packmerger
