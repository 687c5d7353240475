// What a thread does at a disk that may hang, and since when: others see that it does not answer.
#pragma once

#include <mutex>
#include <optional>

#include "base/sign_of_life.h"
#include "base/time/clock.h"
#include "base/time/wall_clock.h"

namespace packmerger {

class Pulse {
 public:
  // While it lives, the thread is at the disk.
  class Stroke {
   public:
    explicit Stroke(Pulse& pulse) : pulse_(pulse), answers_([&pulse] { pulse.set(true); }) {
      pulse_.set(true);
    }
    Stroke(const Stroke&) = delete;
    Stroke& operator=(const Stroke&) = delete;
    ~Stroke() { pulse_.set(false); }

   private:
    Pulse& pulse_;
    AnswerListener answers_;  // it answered, and is asked on: a long copy does not hang
  };

  // Since when (Unix time) it has waited for one answer of the disk, where that is longer than so
  // many seconds. Any thread may ask.
  std::optional<double> hangs_since(double for_s) const {
    const std::lock_guard lock(mutex_);
    const bool hangs = is_there_ && steady_now_s() - since_s_ > for_s;
    return hangs ? std::optional(since_unix_s_) : std::nullopt;
  }

 private:
  void set(bool is_there) {
    const std::lock_guard lock(mutex_);
    is_there_ = is_there;
    since_s_ = steady_now_s();
    since_unix_s_ = unix_now_s();
  }

  mutable std::mutex mutex_;
  bool is_there_ = false;
  double since_s_ = 0;       // on the steady clock
  double since_unix_s_ = 0;  // the same moment
};

}  // namespace packmerger
