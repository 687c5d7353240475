// Work that is counted instead of timed, so that what it ends ends at the same point on every
// machine and on any number of threads.
#pragma once

#include <atomic>
#include <cstdint>

namespace packmerger {

// Thread-safe. Who asks for it while others spend is told what depends on chance.
class Effort {
 public:
  // A step is about a nanosecond of one core.
  void spend(std::uint64_t steps) { spent_.fetch_add(steps, std::memory_order_relaxed); }
  std::uint64_t spent() const { return spent_.load(std::memory_order_relaxed); }

 private:
  std::atomic<std::uint64_t> spent_ = 0;
};

}  // namespace packmerger
