#include "cli/print_dialogue.h"

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "base/time/duration.h"
#include "cli/verb.h"

namespace packmerger::cli {

namespace {

constexpr int kListen_ms = 100;
constexpr int kStep_percent = 5;  // of the lines where there is no bar

int percent_of(const PrintReport& report) {
  if (report.total == 0) return 0;
  return static_cast<int>(
      std::floor(100 * static_cast<double>(report.done) / static_cast<double>(report.total)));
}

// "printing, 120 of 300, 0:12:34, 1:02:00 left"
std::string line_of(const PrintReport& report) {
  std::string text(print_state_name(report.state));
  if (report.done > 0) text += fmt::format(", {} of {}", report.done, report.total);
  text += ", " + duration_text(report.elapsed_s);
  if (report.remaining_s && report.done > 0)
    text += ", " + duration_text(*report.remaining_s) + " left";
  for (const HeaterReport& heater : report.heaters)
    text += fmt::format(", {} {:.0f}{} °C", heater.name, heater.actual_c,
                        heater.target_c ? fmt::format("/{:.0f}", *heater.target_c) : "");
  return text;
}

// Without choices there is nothing to answer here: it waits for paper, say, or for its own button.
std::string question_of(const PrintReport& report) {
  std::string text =
      (report.choices.empty() ? "The printer waits: " : "The printer asks: ") + report.text;
  for (std::size_t i = 0; i < report.choices.size(); ++i)
    text += fmt::format("\n  {}: {}", i, report.choices[i]);
  return text;
}

}  // namespace

PrintDialogue::PrintDialogue(PrintControl& control, bool asks)
    : control_(control), asks_(asks), bar_(::isatty(STDERR_FILENO) == 1) {
  count_interrupts(asks ? 4 : 3);
}

PrintDialogue::~PrintDialogue() { clear_bar(); }

void PrintDialogue::tell(const PrintReport& report) {
  const std::lock_guard lock(mutex_);
  const bool changed = report.state != report_.state || report.text != report_.text ||
                       report.choices != report_.choices;
  report_ = report;
  show(report);
  if (!changed) return;
  if (report.state == PrintState::kWaiting && !report.text.empty()) {
    if (asks_ && question_ != Question::kHowToGoOn && !report.choices.empty())
      ask_for_printer();
    else
      say(question_of(report));
  }
  const bool told = report.state == PrintState::kPaused || report.state == PrintState::kPrinting;
  if (told && !report.text.empty()) say(report.text);
  if (report.state == PrintState::kCancelling)
    say(report.text.empty() ? "Cancelling, please wait until the printer has stopped."
                            : "Cancelling: " + report.text + ".");
  if (report.state != PrintState::kWaiting && question_ == Question::kOfPrinter)
    question_ = Question::kNone;
}

void PrintDialogue::listen() {
  hear_signals();
  pollfd entry{STDIN_FILENO, POLLIN, 0};
  const bool hears = asks_ && !input_ended_;
  if (::poll(&entry, hears ? 1 : 0, kListen_ms) <= 0) return;
  char bytes[256];
  const ssize_t count = ::read(STDIN_FILENO, bytes, sizeof bytes);
  if (count == 0 || (count < 0 && errno != EINTR && errno != EAGAIN)) input_ended_ = true;
  for (ssize_t i = 0; i < count; ++i) {
    if (bytes[i] != '\n') {
      typed_ += bytes[i];
      continue;
    }
    take_line(typed_);
    typed_.clear();
  }
}

void PrintDialogue::hear_signals() {
  const bool again = interrupts() > heard_;
  heard_ = interrupts();
  if (!again && !interrupted()) return;
  const std::lock_guard lock(mutex_);
  if (heard_ >= (asks_ ? 3 : 2)) {
    left_ = true;
    question_ = Question::kNone;
    return control_.leave();
  }
  const bool pauses = again && asks_ && question_ != Question::kHowToGoOn && !interrupted();
  if (pauses && !cancelled_) {
    control_.pause();
    return ask(Question::kHowToGoOn, "Pausing. g: go on, c: cancel, s: stop at once? ");
  }
  cancelled_ = true;
  question_ = Question::kNone;
  control_.cancel();
}

void PrintDialogue::take_line(const std::string& line) {
  const std::lock_guard lock(mutex_);
  const Question question = std::exchange(question_, Question::kNone);
  if (question == Question::kOfPrinter) return control_.answer(std::atoi(line.c_str()));
  if (question == Question::kNone) return;
  const char choice = line.empty() ? '?' : line[0];
  if (choice == 'g') return go_on();
  if (choice == 'c') return control_.cancel();
  if (choice == 's') return control_.stop_at_once();
  ask(Question::kHowToGoOn, "g: go on, c: cancel, s: stop at once? ");
}

void PrintDialogue::go_on() {
  forget_interrupts();
  heard_ = 0;
  control_.resume();
  // What the printer asked before, or meanwhile, it asks still.
  if (report_.state == PrintState::kWaiting && !report_.choices.empty()) ask_for_printer();
}

void PrintDialogue::ask_for_printer() {
  ask(Question::kOfPrinter, question_of(report_) + "\nYour answer (Enter: the first): ");
}

void PrintDialogue::ask(Question question, const std::string& text) {
  question_ = question;
  clear_bar();
  fmt::print(stderr, "{}", text);
  std::fflush(stderr);
}

// While a question stands there, the bar would write over it.
void PrintDialogue::show(const PrintReport& report) {
  if (question_ != Question::kNone) return;
  const int percent = percent_of(report);
  if (bar_) {
    const std::string bar =
        fmt::format("[{:<25}] {:3} % {}", std::string(static_cast<std::size_t>(percent / 4), '#'),
                    percent, line_of(report));
    if (bar == shown_) return;
    shown_ = bar;
    fmt::print(stderr, "\r\033[K{}", bar);
  } else {
    if (report.state == shown_state_ && shown_percent_ >= 0 &&
        std::abs(percent - shown_percent_) < kStep_percent)
      return;
    fmt::print(stderr, "[{:3}%] {}\n", percent, line_of(report));
  }
  shown_percent_ = percent;
  shown_state_ = report.state;
  std::fflush(stderr);
}

void PrintDialogue::say(const std::string& text) {
  clear_bar();
  fmt::print(stderr, "{}\n", text);
}

void PrintDialogue::clear_bar() {
  if (bar_ && !shown_.empty()) fmt::print(stderr, "\r\033[K");
  shown_.clear();
}

}  // namespace packmerger::cli
