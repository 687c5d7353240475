// What a map of heights holds where nothing was hit.
#pragma once

#include <limits>

namespace packmerger {

// Below everything when looked at from above, above everything from below, so that min and max need
// no special case.
inline constexpr float kNothingBelow = -std::numeric_limits<float>::infinity();
inline constexpr float kNothingAbove = std::numeric_limits<float>::infinity();

}  // namespace packmerger
