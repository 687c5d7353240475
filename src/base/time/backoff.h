// How long to wait before what failed is tried again.
#pragma once

#include <algorithm>

namespace packmerger {

inline constexpr int kMostDoublings = 4;

// After the first failure (failures is then 0) first_s, and twice as long after each further one,
// up to sixteen times, or as often doubled as is said.
inline double backoff_s(double first_s, int failures, int most_doublings = kMostDoublings) {
  return first_s * (1 << std::clamp(failures, 0, most_doublings));
}

}  // namespace packmerger
