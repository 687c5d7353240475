// Which side of each piece of a closed surface the matter is on. Used by repair.
#pragma once

#include "model/mesh.h"

namespace packmerger {

struct Orientation {
  int pieces = 0;          // that are left
  int facets_removed = 0;  // of flat sheets, and of pieces within matter
  int swallowed = 0;       // pieces within matter
};

// Turns each edge-connected piece out of the matter. The file's own turning tells what a piece
// within another one is: turned against the piece around it, it is the wall of a cavity; turned
// like it, it lies within matter, adds none, and is removed, as slicers do by the winding number.
// Whether the outermost piece is turned outwards or inwards does not count. Flat sheets go. soup:
// closed; each piece's triangles are turned alike.
Orientation orient_outwards(TriangleSoup& soup);

}  // namespace packmerger
