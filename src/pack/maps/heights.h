// Heights as the packer computes with them: whole units in 16 bits, so that the placement kernel
// handles many positions in one instruction.
#pragma once

#include <cstdint>

namespace packmerger {

using Height = std::int16_t;

// The plate as parts' lower sides meet it: no part needs a gap to it, so it never decides a height.
inline constexpr Height kBarePlate = -16384;

// A cell of a part's map; x and y count cells from the map's corner.
struct HeightCell {
  std::int16_t x = 0;
  std::int16_t y = 0;
  Height value = 0;

  bool operator==(const HeightCell&) const = default;
};

}  // namespace packmerger
