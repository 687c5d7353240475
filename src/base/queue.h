// The one way in which the daemon's threads exchange values.
#pragma once

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <utility>

#include "base/error.h"

namespace packmerger {

// First in, first out; any number of threads may push and pop. fd() is readable while something
// waits or the queue is closed, so that a thread can wait for it together with sockets and files.
template <typename T>
class Queue {
 public:
  Queue() : fd_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
    if (fd_ < 0)
      throw Error(Fault::kInternal, "No file descriptor is left",
                  "Raise the limit on open files (ulimit -n) and start again.");
  }
  Queue(const Queue&) = delete;
  Queue& operator=(const Queue&) = delete;
  ~Queue() { ::close(fd_); }

  int fd() const { return fd_; }

  // A value pushed after close() is dropped: nobody is left to take it.
  void push(T value) {
    const std::lock_guard lock(mutex_);
    if (closed_) return;
    values_.push_back(std::move(value));
    if (values_.size() == 1) raise();
  }

  // The oldest value, or nothing when none waits.
  std::optional<T> try_pop() {
    const std::lock_guard lock(mutex_);
    if (values_.empty()) return std::nullopt;
    std::optional<T> value(std::move(values_.front()));
    values_.pop_front();
    if (values_.empty() && !closed_) lower();
    return value;
  }

  // Waits for a value. Nothing when the queue was closed and is empty.
  std::optional<T> pop() {
    for (;;) {
      if (std::optional<T> value = try_pop()) return value;
      if (closed()) return std::nullopt;
      pollfd waiting{fd_, POLLIN, 0};
      ::poll(&waiting, 1, -1);
    }
  }

  // What was pushed before can still be taken.
  void close() {
    const std::lock_guard lock(mutex_);
    if (closed_) return;
    closed_ = true;
    if (values_.empty()) raise();
  }

  bool closed() const {
    const std::lock_guard lock(mutex_);
    return closed_;
  }

 private:
  void raise() {
    const std::uint64_t one = 1;
    while (::write(fd_, &one, sizeof one) < 0 && errno == EINTR) {
    }
  }
  void lower() {
    std::uint64_t count = 0;
    while (::read(fd_, &count, sizeof count) < 0 && errno == EINTR) {
    }
  }

  mutable std::mutex mutex_;
  std::deque<T> values_;
  bool closed_ = false;
  int fd_;
};

}  // namespace packmerger
