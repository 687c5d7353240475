// What `send` shows of a print, and what a person at its terminal may ask for.
#pragma once

#include <mutex>
#include <string>

#include "firmware_io/print_state.h"

namespace packmerger::cli {

// On a terminal the first Ctrl-C pauses the print and asks (go on, cancel, stop at once), the
// second cancels; without one the first cancels. SIGTERM cancels. One more writes what turns the
// heaters off and waits for nothing; a further one ends the program as it stands.
class PrintDialogue {
 public:
  // asks: there is a person at a terminal.
  PrintDialogue(PrintControl& control, bool asks);
  PrintDialogue(const PrintDialogue&) = delete;
  PrintDialogue& operator=(const PrintDialogue&) = delete;
  ~PrintDialogue();

  // On the thread that prints.
  void tell(const PrintReport& report);

  // On the other: hears signals and typed lines for a tenth of a second.
  void listen();
  // A person waits no longer, not even for the printer.
  bool has_left() const { return left_; }

 private:
  enum class Question { kNone, kHowToGoOn, kOfPrinter };

  void hear_signals();
  void take_line(const std::string& line);
  void go_on();
  void ask_for_printer();
  void ask(Question question, const std::string& text);
  void show(const PrintReport& report);
  void say(const std::string& text);
  void clear_bar();

  PrintControl& control_;
  const bool asks_;
  const bool bar_;
  int heard_ = 0;  // interrupts
  bool cancelled_ = false;
  bool left_ = false;
  bool input_ended_ = false;
  std::string typed_;

  std::mutex mutex_;  // for what both threads use, below
  Question question_ = Question::kNone;
  std::string shown_;  // the bar or line
  int shown_percent_ = -1;
  PrintState shown_state_ = PrintState::kConnecting;
  PrintReport report_;
};

}  // namespace packmerger::cli
