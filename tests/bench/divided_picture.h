// Pictures of a model that is divided into segments.
#pragma once

#include "model/segments.h"
#include "model/tet_mesh.h"
#include "picture/preview.h"

namespace packmerger::bench {

// The model's outside with the segment that each of its faces belongs to. y_up: the mesh's y axis
// points up, and is turned.
ColouredMesh outside_of(const TetMesh& mesh, const Segments& segments, bool y_up);

// Half as wide and high, four pixels' mean each.
Image halved(const Image& image);

}  // namespace packmerger::bench
