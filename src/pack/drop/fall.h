// The packer's two inner loops, over blocks of neighbouring positions of one part, in whole units
// of height and with the widest vectors that the processor has (Highway, chosen at run time).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "pack/maps/heights.h"

namespace packmerger {

// Positions of a block: one behind the other along x. Several blocks are handled at once, so that
// all the processor's loads are in flight; they may lie anywhere.
inline constexpr int kFallPositions = 32;
// Entries of the field that may be read to the right of the last cell a block needs.
inline constexpr int kFallReadAhead = kFallPositions - 1;

// A field is an array of rows, `stride` entries apart; round what is asked lie as many cells as the
// part stands out, so that no limits are tested here.
struct FallBlock {
  const Height* field = nullptr;  // where the part's cell (0, 0) lies at the first position
  Height* heights = nullptr;      // of kFallPositions
  Height give_up_above = 0;
};

// Raises every height of every block to how high the part's origin comes to lie when it is dropped
// there: the maximum of what was in it and field(cell) - cell.value over the cells, where a
// difference beyond the range of a Height is the end of that range. The blocks with a height that
// is not above their give_up_above come first afterwards, in the order they had; returned is their
// number. The heights of the others may be too low, but not as low as that. Cells that raise many
// positions should come first.
std::size_t fall(std::span<FallBlock> blocks, std::ptrdiff_t stride,
                 std::span<const HeightCell> cells);

// sums[i], kFallPositions for each block: the sum of max(0, field(cell)) over the cells, however
// many there are; their values do not enter.
void sum_field(std::span<const FallBlock> blocks, std::ptrdiff_t stride,
               std::span<const HeightCell> cells, std::int64_t* sums);

}  // namespace packmerger
