// How far a mended surface is from the one that the file holds.
#pragma once

#include "base/progress.h"
#include "model/mesh.h"
#include "model/warning.h"

namespace packmerger {

struct Mending {
  const TriangleSoup& before;  // as the file holds it, not empty
  bool was_closed = false;
  const TriangleSoup& after;  // closed, outward
  bool is_skin = false;       // a hole over the whole width was closed
  bool swallowed = false;     // pieces within matter were left out
};

// Adds the warning "shape_changed" where mending changed the area by more than 1 %, or the volume
// of what was closed, made a body of a skin, closed a hole whose new surface reaches further than
// 1 % of the longest side from the old one (about twice as wide a hole), or left out or moved
// points that are now outside and as far from the new one. Facets in the same place, whichever way
// turned, were not moved.
void warn_of_change(const Mending& mending, Warnings& warnings, const Progress& progress);

}  // namespace packmerger
