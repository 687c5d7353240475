// Progress reports and cancellation, handed down by reference through every long verb.
#pragma once

#include <atomic>
#include <functional>
#include <string_view>

#include "base/error.h"

namespace packmerger {

// Copyable and cheap. report() and check() may be called from any thread as long as the listener
// is thread-safe.
class Progress {
 public:
  // stage: a short present participle shown to people ("packing"); fraction: 0..1 of that stage.
  using Listener = std::function<void(std::string_view stage, double fraction)>;

  Progress() = default;  // silent, cannot be cancelled
  Progress(Listener listener, const std::atomic<bool>* cancelled)
      : listener_(std::move(listener)), cancelled_(cancelled) {}

  // Throws Error{kInterrupted} when cancellation was asked for.
  void report(std::string_view stage, double fraction) const {
    check();
    if (listener_) listener_(stage, fraction);
  }

  // What asks for cancellation, for a progress of another listener; nullptr: nothing does.
  const std::atomic<bool>* cancelled() const { return cancelled_; }

  // The cheap test for inner loops. Throws as report() does.
  void check() const {
    if (cancelled_ != nullptr && cancelled_->load(std::memory_order_relaxed))
      throw Error(Fault::kInterrupted, "Interrupted", "");
  }

 private:
  Listener listener_;
  const std::atomic<bool>* cancelled_ = nullptr;
};

}  // namespace packmerger
