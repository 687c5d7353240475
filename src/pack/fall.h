// The packer's two inner loops, over one row of positions of one part, in whole units of height
// and with the widest vectors that the processor has (Highway, chosen at run time).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "pack/heights.h"

namespace packmerger {

// Positions behind the last that the loops read the field for, and entries of the field that they
// may read to the right of the last cell they need.
inline constexpr int kFallReadAhead = 31;

// A field is an array of rows, `stride` entries apart. field_origin points at its cell (0, 0);
// round it lie as many cells as parts at the asked positions stand out, so that no limits are
// tested here.

// heights[i], 0 <= i < n: how high the part's origin comes to lie when it is dropped at position
// (x + i, y): max(floor, field(x + i + cell.x, y + cell.y) - cell.value) over the cells, where a
// difference beyond the range of a Height is the end of that range. Where all of up to 128
// neighbouring positions come to lie above give_up_above, their heights may be too low, but not as
// low as that.
void fall(const Height* field_origin, std::ptrdiff_t stride, std::span<const HeightCell> cells,
          int x, int y, Height floor, Height give_up_above, Height* heights, int n);

// sums[i], 0 <= i < n: the sum of max(0, field(x + i + cell.x, y + cell.y)) over the cells, for up
// to 65536 of them; their values do not enter.
void sum_field(const Height* field_origin, std::ptrdiff_t stride, std::span<const HeightCell> cells,
               int x, int y, std::int32_t* sums, int n);

}  // namespace packmerger
