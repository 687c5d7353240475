// Heights as the packer computes with them: whole units in 16 bits, so that the placement kernel
// handles many positions in one instruction.
#pragma once

#include <cstdint>

namespace packmerger {

using Height = std::int16_t;

inline constexpr Height kNothing = -32768;  // no matter in this cell
// The plate as parts' lower sides meet it: no part needs a gap to it, so it never decides a height.
inline constexpr Height kBarePlate = -16384;

// A cell of a part's map; x and y count cells from the map's corner.
struct HeightCell {
  std::int16_t x = 0;
  std::int16_t y = 0;
  Height value = 0;

  bool operator==(const HeightCell&) const = default;
};

// Length of a unit, mm, for a build volume of this height: 1/64, or more where the sum of two
// heights would not fit 16 bits.
double height_unit_mm(double build_z_mm);

}  // namespace packmerger
