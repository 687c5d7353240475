// A small boat, as it is printed to try a printer.
#pragma once

#include "model/mesh.h"

namespace packmerger::bench {

// 60 x 31 x 48 mm, keel down: an open hull that narrows towards bow and keel, and a hollow cabin
// with a window through both its sides, a door, a roof and a chimney. 15.5 cm³; closed, one body,
// without intersections.
Mesh hull_part();

}  // namespace packmerger::bench
