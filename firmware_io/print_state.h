// What a print in progress tells, and how it is told to pause and to stop.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace packmerger {

enum class PrintState { kConnecting, kHeating, kPrinting, kPaused, kWaiting, kCancelling, kDone };

// "connecting", "heating", "printing", "paused", "waiting", "cancelling", "done".
std::string_view print_state_name(PrintState state);

// As the machine told it last.
struct HeaterReport {
  std::string name;  // "tool", "tool 1", "bed", "chamber"
  double actual_c = 0;
  std::optional<double> target_c;  // 0: off

  bool operator==(const HeaterReport&) const = default;
};

// `done` of `total` program lines (G-code) or bytes (x3g, USB) were taken by the printer.
// `text` is for people and may be empty: temperatures, or what the printer waits for.
struct PrintReport {
  PrintState state = PrintState::kConnecting;
  std::size_t done = 0;
  std::size_t total = 0;
  std::string text;
  std::vector<std::string> choices;   // of kWaiting: the buttons, for answer(); may be empty
  std::vector<HeaterReport> heaters;  // empty until the machine tells
  double elapsed_s = 0;               // since the link began
  std::optional<double> remaining_s;  // learned while printing; pauses to come are not in it
};

// Whether the first byte of the job was sent, or is about to be.
inline bool has_begun(const PrintReport& report) {
  return report.done > 0 ||
         (report.state != PrintState::kConnecting && report.state != PrintState::kWaiting &&
          report.state != PrintState::kCancelling);
}

// Called on the thread that prints: at every change of state, and otherwise from once to ten times
// a second. Before the first byte of the job is sent the state is kPrinting; nothing but
// kConnecting, and kWaiting at a printer that cannot begin, comes before. Must return quickly; an
// exception thrown by it ends the print as a failure does.
using PrintListener = std::function<void(const PrintReport&)>;

// Called on the thread that prints, before anything further is sent: `done` of `total` lines or
// bytes were acknowledged. Called again at least once a second although nothing has changed.
using AcknowledgeListener = std::function<void(std::size_t done, std::size_t total)>;

struct StreamOptions {
  double timeout_s = 30;     // silence after which the printer counts as gone
  double boot_wait_s = 2;    // after opening, for boards that reset
  std::string build_name;    // shown by the printer where the program names no build; may be cut
  std::string safe_gcode;    // G-code: sent after a failure or a cancel; heaters off
  std::string pause_gcode;   // G-code: executed once a print stands paused
  std::string resume_gcode;  // G-code: executed before it goes on
  std::string machine;       // must be in what the machine says of itself; empty: any machine
  AcknowledgeListener on_acknowledged;
  std::size_t window_bytes = 0;  // G-code: unacknowledged bytes at most; 0: one line at a time
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

  // The machine stops where it stands and must be looked at: G-code's M112, s3g's abort. The print
  // fails, and nothing is sent after it.
  void stop_at_once() { stopped_ = true; }
  bool stopped() const { return stopped_; }

  // For a person who waits no longer for a cancel: the link writes what turns the heaters off,
  // waits for nothing and ends. What cancels at once anyway only cancels.
  void leave() {
    left_ = true;
    cancelled_ = true;
  }
  bool left() const { return left_; }

  // The print stands still at the end of a command, its heaters on, until it is resumed or
  // cancelled; state kPaused says when. Resuming also ends a pause that the machine began.
  void pause() { pause_request_ = 1; }
  void resume() { pause_request_ = 0; }
  // For links: what was asked since the last call; true: pause.
  std::optional<bool> take_pause_request() {
    const int request = pause_request_.exchange(-1);
    if (request < 0) return std::nullopt;
    return request == 1;
  }

  // Answers a printer in state kWaiting: the index of the chosen button, 0 to go on.
  void answer(int choice) { answer_ = choice; }
  // For links: the answer given since the last call, or -1.
  int take_answer() { return answer_.exchange(-1); }

 private:
  std::atomic<bool> cancelled_{false};
  std::atomic<bool> stopped_{false};
  std::atomic<bool> left_{false};
  std::atomic<int> pause_request_{-1};
  std::atomic<int> answer_{-1};
  const std::atomic<bool>* interrupted_ = nullptr;
};

}  // namespace packmerger
