// Which layers a tray is cut into, and which of them lie between two heights.
#pragma once

#include <vector>

#include "model/mesh.h"

namespace packmerger {

// Layer k is cut at (k + 1/2) · layer_mm above the plate, k from 0 to the count.

// ceil(height / layer), forgiving rounding: 56 mm at 0.2 mm is 280 layers, not 281.
int layer_count(double height_mm, double layer_mm);

// The height of the tallest part, mm; 0 where there is none.
double top_of(const std::vector<const Mesh*>& parts);

// The layers whose middle plane lies in (low, high], as [first, end). A corner in the plane itself
// counts as above it, everywhere, so that contours close.
struct LayerRange {
  int first = 0;
  int end = 0;
};
LayerRange layers_between(double low_mm, double high_mm, double layer_mm, int count);

}  // namespace packmerger
