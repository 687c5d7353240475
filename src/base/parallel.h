// Data parallelism over oneTBB. Results must be written by index, so that the outcome is the same
// on one thread and on many.
#pragma once

#include <cstddef>

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_group.h>

namespace packmerger {

// Calls body(i) once for each i in [0, count), in any order and on any thread. An exception thrown
// by a body stops the loop and is re-thrown here.
template <typename Body>
void parallel_for(std::size_t count, const Body& body) {
  tbb::parallel_for(std::size_t{0}, count, body);
}

// The same for a few long bodies: each may be taken by another thread by itself, where
// parallel_for hands out neighbours together.
template <typename Body>
void parallel_tasks(std::size_t count, const Body& body) {
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, count, 1),
      [&body](const tbb::blocked_range<std::size_t>& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) body(i);
      },
      tbb::simple_partitioner());
}

// Work that goes on beside the caller's, on threads that parallel_for leaves idle.
class Beside {
 public:
  Beside() = default;
  Beside(const Beside&) = delete;
  Beside& operator=(const Beside&) = delete;
  // Ends what has not begun and waits for the rest; what it threw is lost.
  ~Beside() {
    group_.cancel();
    try {
      group_.wait();
    } catch (...) {  // the caller is leaving on an error of its own
    }
  }

  // work must stay valid until wait() or the end.
  template <typename Work>
  void run(const Work& work) {
    group_.run(work);
  }
  // Waits for all of it, and re-throws what one of it threw.
  void wait() { group_.wait(); }

 private:
  tbb::task_group group_;
};

// While alive, at most `threads` threads are used by parallel_for. For tests and --threads.
class ThreadLimit {
 public:
  explicit ThreadLimit(std::size_t threads)
      : control_(tbb::global_control::max_allowed_parallelism, threads) {}

 private:
  tbb::global_control control_;
};

}  // namespace packmerger
