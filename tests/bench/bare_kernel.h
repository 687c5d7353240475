// The least that the packer's inner loop has to do, as the measure of how fast it could run.
#pragma once

#include <cstdint>
#include <span>

namespace packmerger::bench {

inline constexpr int kBarePositions = 64;

struct BareCell {
  std::int32_t offset = 0;  // from the first position's entry of the field
  std::int16_t value = 0;
};

// heights[i] = max(heights[i], field[cell.offset + i] - cell.value), saturating, for 64 positions:
// no ends of rows, no looks whether all are too high, nothing to compute but what is in the
// formula.
void bare_fall(const std::int16_t* field, std::span<const BareCell> cells, std::int16_t* heights);

}  // namespace packmerger::bench
