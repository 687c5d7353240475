// What a print in progress tells, and how it is told to stop.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <string>
#include <string_view>

namespace packmerger {

enum class PrintState { kConnecting, kHeating, kPrinting, kPaused, kWaiting, kCancelling, kDone };

// "connecting", "heating", "printing", "paused", "waiting", "cancelling", "done".
std::string_view print_state_name(PrintState state);

// `done` of `total` program lines (G-code) or bytes (x3g) were acknowledged by the printer.
// `text` is for people and may be empty: temperatures, or what the printer waits for.
struct PrintReport {
  PrintState state = PrintState::kConnecting;
  std::size_t done = 0;
  std::size_t total = 0;
  std::string text;
};

// Called on the thread that prints: at every change of state and otherwise at most ten times a
// second. Must return quickly; an exception thrown by it ends the print as a failure does.
using PrintListener = std::function<void(const PrintReport&)>;

struct StreamOptions {
  double timeout_s = 30;   // silence after which the printer counts as gone
  double boot_wait_s = 2;  // after opening, for boards that reset
  std::string build_name;  // shown by the printer where the program names no build; may be cut
  std::string safe_gcode;  // G-code: sent after a failure or a cancel; heaters off
};

// Requests to a running print. Every member may be called from any thread.
class PrintControl {
 public:
  PrintControl() = default;
  // Also cancelled once *interrupted is true (a signal handler's flag; it outlives this object).
  explicit PrintControl(const std::atomic<bool>* interrupted) : interrupted_(interrupted) {}

  // The link acts on it within a second, whatever it is waiting for.
  void cancel() { cancelled_ = true; }
  bool cancelled() const { return cancelled_ || (interrupted_ != nullptr && *interrupted_); }

  // Answers a printer in state kWaiting: the index of the chosen button, 0 to go on.
  void answer(int choice) { answer_ = choice; }
  // For links: the answer given since the last call, or -1.
  int take_answer() { return answer_.exchange(-1); }

 private:
  std::atomic<bool> cancelled_{false};
  std::atomic<int> answer_{-1};
  const std::atomic<bool>* interrupted_ = nullptr;
};

}  // namespace packmerger
