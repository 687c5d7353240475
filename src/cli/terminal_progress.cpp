#include <fmt/format.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>
#include <mutex>
#include <string>

#include "cli/late_stop.h"
#include "cli/verb.h"

namespace packmerger::cli {
namespace {

// A signal handler has no other way to speak to the program.
std::atomic<bool> interrupt_flag{false};

std::atomic<int> interrupt_count{0};
std::atomic<int> deadly_count{2};

void on_signal(int) {
  interrupt_flag.store(true);
  stop_asked();
}

void on_counted_signal(int number) {
  if (++interrupt_count < deadly_count) return;
  ::signal(number, SIG_DFL);
  ::raise(number);
}

class Reporter {
 public:
  void show(std::string_view stage, double fraction) {
    const std::lock_guard lock(mutex_);
    const int percent = static_cast<int>(std::floor(100 * std::clamp(fraction, 0.0, 1.0)));
    if (stage == stage_ && std::abs(percent - percent_) < (terminal_ ? 1 : 5)) return;
    stage_ = stage;
    percent_ = percent;
    if (terminal_)
      fmt::print(stderr, "\r\033[K{:<14} [{:<25}] {:3} %", stage, std::string(percent / 4, '#'),
                 percent);
    else
      fmt::print(stderr, "[{:3}%] {}\n", percent, stage);
    std::fflush(stderr);
  }

  ~Reporter() {
    if (terminal_ && !stage_.empty()) fmt::print(stderr, "\r\033[K");
  }

 private:
  std::mutex mutex_;
  const bool terminal_ = ::isatty(STDERR_FILENO) == 1;
  std::string stage_;
  int percent_ = -1;
};

}  // namespace

const std::atomic<bool>& interrupted() { return interrupt_flag; }

void count_interrupts(int deadly) {
  deadly_count = deadly;
  struct sigaction action {};
  action.sa_handler = on_counted_signal;
  ::sigaction(SIGINT, &action, nullptr);
  action.sa_handler = on_signal;
  ::sigaction(SIGTERM, &action, nullptr);
}

int interrupts() { return interrupt_count; }

void forget_interrupts() { interrupt_count = 0; }

Progress terminal_progress() {
  struct sigaction action {};
  action.sa_handler = on_signal;
  action.sa_flags = static_cast<int>(SA_RESETHAND);  // a second Ctrl-C ends the program at once
  ::sigaction(SIGINT, &action, nullptr);
  ::sigaction(SIGTERM, &action, nullptr);
  auto reporter = std::make_shared<Reporter>();
  return Progress(
      [reporter](std::string_view stage, double fraction) { reporter->show(stage, fraction); },
      &interrupt_flag);
}

}  // namespace packmerger::cli
