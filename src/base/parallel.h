// Data parallelism over oneTBB. Results must be written by index, so that the outcome is the same
// on one thread and on many.
#pragma once

#include <cstddef>

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

namespace packmerger {

// Calls body(i) once for each i in [0, count), in any order and on any thread. An exception thrown
// by a body stops the loop and is re-thrown here.
template <typename Body>
void parallel_for(std::size_t count, const Body& body) {
  tbb::parallel_for(std::size_t{0}, count, body);
}

// While alive, at most `threads` threads are used by parallel_for. For tests and --threads.
class ThreadLimit {
 public:
  explicit ThreadLimit(std::size_t threads)
      : control_(tbb::global_control::max_allowed_parallelism, threads) {}

 private:
  tbb::global_control control_;
};

}  // namespace packmerger
