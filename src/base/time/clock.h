// The clock that never goes back.
#pragma once

#include <chrono>

namespace packmerger {

// Seconds since some moment before this program began.
inline double steady_now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace packmerger
