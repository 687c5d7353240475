// Small parts of seven kinds, as a workshop's tray holds them.
#pragma once

#include <cstdint>
#include <vector>

#include "model/packing.h"

namespace packmerger::bench {

// The kinds in turn, every part at a scale of its own between 0.8 and 1.2, none merging with
// another: cubes of 22 mm; tori of ring radius 13 and tube radius 5.5 mm; cups of radius 13, height
// 28 and wall 3 mm; spheres of radius 13 mm; L of legs 32, thickness 12 and depth 16 mm; U of width
// 32, legs 28, thickness 9 and depth 16 mm; corners of a cube with sides of 38 mm.
std::vector<PackItem> mixed_items(int count, std::uint64_t seed);

}  // namespace packmerger::bench
