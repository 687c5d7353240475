// The two inner loops of the packer, over one row of positions of one part.
#pragma once

#include <vector>

#include "pack/height_field.h"
#include "pack/part.h"

namespace packmerger {

// heights[i]: how high the part's origin comes to lie when it is dropped at position (x + i, y):
// the (max, +) scan max(floor, field - reach) over the cells of `reach`. Where all of up to 16
// neighbouring positions come to lie above give_up_above, their heights may be too low, but not
// lower than that. Reads up to 15 positions behind the last.
void fall(const CellField& upper, const std::vector<MapCell>& reach, int x, int y, float floor,
          float give_up_above, std::vector<float>& heights);

// sums[i]: sum of the field under the cells of the part at position (x + i, y), each as many times
// as its value says where weighted. Reads up to 15 positions behind the last.
void sum_field(const CellField& surface, const std::vector<MapCell>& cells, bool weighted, int x,
               int y, std::vector<float>& sums);

// Positions that the loops may read behind the last one asked for.
inline constexpr int kReadAhead = 15;

}  // namespace packmerger
