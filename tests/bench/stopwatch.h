// How long something takes, and how much of that the processor worked on it.
#pragma once

#include <chrono>
#include <ctime>

namespace packmerger::bench {

class Stopwatch {
 public:
  double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }
  // Of all threads of this program; far less than `seconds` on one thread: others were at work.
  double processor_seconds() const { return processor_now() - processor_start_; }

 private:
  static double processor_now() {
    std::timespec now{};
    ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
  }

  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  double processor_start_ = processor_now();
};

}  // namespace packmerger::bench
