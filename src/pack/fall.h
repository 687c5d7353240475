// The two inner loops of the packer, over a row of positions of one part.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "pack/heights.h"

namespace packmerger {

// Positions that the loops may read behind the last one asked for.
inline constexpr std::size_t kReadAhead = 256;

void fall(const Height* field, std::ptrdiff_t stride, std::span<const HeightCell> cells, int x,
          int y, Height floor, Height give_up_above, Height* heights, int n);
void sum_field(const Height* field, std::ptrdiff_t stride, std::span<const HeightCell> cells, int x,
               int y, std::int32_t* sums, int n);

}  // namespace packmerger
