// The clock that people read.
#pragma once

#include <chrono>

namespace packmerger {

inline double unix_now_s() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

}  // namespace packmerger
