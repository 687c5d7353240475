// Waiting a moment for what a process that was just killed still holds: a child that it was
// starting has its sockets until it becomes another program, or dies of its parent's death.
#pragma once

#include <chrono>
#include <thread>

namespace packmerger {

// True as soon as holds() is, which is asked for a second at most; false after that.
template <typename Holds>
bool soon(const Holds& holds) {
  constexpr std::chrono::milliseconds kPause{10};
  constexpr int kTries = 100;
  for (int i = 0; i < kTries; ++i) {
    if (holds()) return true;
    std::this_thread::sleep_for(kPause);
  }
  return holds();
}

}  // namespace packmerger
