// A thread that works at a disk tells after each call that the disk answered. Whoever watches the
// thread hears of it, and so knows a copy that takes minutes from a single call that hangs.
#pragma once

#include <cerrno>
#include <functional>
#include <utility>

namespace packmerger {

// While it lives, it hears of each answer to the thread that made it.
class AnswerListener {
 public:
  explicit AnswerListener(std::function<void()> on_answer)
      : on_answer_(std::move(on_answer)), before_(std::exchange(current(), this)) {}
  AnswerListener(const AnswerListener&) = delete;
  AnswerListener& operator=(const AnswerListener&) = delete;
  ~AnswerListener() { current() = before_; }

  // Tells the calling thread's listener, where it has one. errno stays.
  static void tell() {
    const int before = errno;
    if (current() != nullptr) current()->on_answer_();
    errno = before;
  }

 private:
  static AnswerListener*& current() {
    static thread_local AnswerListener* listener = nullptr;
    return listener;
  }

  std::function<void()> on_answer_;
  AnswerListener* before_;
};

// To be called after each call that waits for a disk.
inline void disk_answered() { AnswerListener::tell(); }

}  // namespace packmerger
