// Parts as a workshop's jobs hold them.
#pragma once

#include <cstdint>
#include <vector>

#include "model/packing.h"

namespace packmerger::bench {

inline constexpr int kFunctionalParts = 60;
inline constexpr double kFunctionalVolume_mm3 = 351e3;  // of all

// Brackets, channels, gears, tubes, open boxes, a lid for each, hooks and hole plates in turn, none
// merging with another. Every size is drawn, and all parts are scaled alike to the volume above;
// the longest side of each is between 15 and 60 mm. Closed, without intersections.
std::vector<PackItem> functional_items(std::uint64_t seed);

}  // namespace packmerger::bench
