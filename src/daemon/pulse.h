// What a thread does at a disk that may hang, and since when: others see that it does not answer.
#pragma once

#include <mutex>

#include "base/clock.h"

namespace packmerger {

class Pulse {
 public:
  // While it lives, the thread is at the disk.
  class Stroke {
   public:
    explicit Stroke(Pulse& pulse) : pulse_(pulse) { pulse_.set(steady_now_s()); }
    Stroke(const Stroke&) = delete;
    Stroke& operator=(const Stroke&) = delete;
    ~Stroke() { pulse_.set(0); }

   private:
    Pulse& pulse_;
  };

  // Whether it has been there for longer than that. Any thread may ask.
  bool hangs(double for_s) const {
    const std::lock_guard lock(mutex_);
    return since_s_ > 0 && steady_now_s() - since_s_ > for_s;
  }

 private:
  void set(double since_s) {
    const std::lock_guard lock(mutex_);
    since_s_ = since_s;
  }

  mutable std::mutex mutex_;
  double since_s_ = 0;  // 0: not there
};

}  // namespace packmerger
