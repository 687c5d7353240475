// What both links share: waiting in short slices so that a cancel acts at once, lines of progress.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "firmware_io/ports/port.h"
#include "firmware_io/print_state.h"
#include "firmware_io/remaining_time.h"

namespace packmerger {

// Longest uninterrupted wait of a link; a cancel is seen within it.
inline constexpr double kSlice_s = 0.1;

// Writes all of it. Throws Error{kIo} when the port takes nothing for five seconds.
void write_all(Port& port, std::string_view bytes);

// Throws Error{kInterrupted} when a print is to end that has not begun.
void check_not_ended(const PrintControl& control);

// `says`: what the machine at `port` says of itself. Throws Error{kUnavailable}, naming both, where
// `wanted` is not in it, whatever the case of its letters.
void check_machine(const std::string& port, const std::string& says, const std::string& wanted);

// What a print fails with that was stopped at once.
[[noreturn]] void throw_stopped();

// What to do where nobody knows whether a printer obeyed its last command.
inline constexpr const char* kMayBeHot =
    "Its heaters may be on: look at the machine, and switch it off and on before the next job.";
// In the place of `error`, which happened on the way of a cancel: the cause told is the cancel.
[[noreturn]] void throw_failed_cancel(const Error& error, bool at_printer = false);

// Keeps a print's listeners informed: of every change of state and acknowledgement at once, of
// progress ten times a second.
class Reporter {
 public:
  Reporter(const Port& port, const PrintListener& listener, const StreamOptions& options,
           std::size_t total, RemainingTime remaining);

  void state(PrintState state, std::string text = "", std::vector<std::string> choices = {});
  void done(std::size_t done);
  void heaters(std::vector<HeaterReport> heaters);
  // To be called whenever the link has waited.
  void tick();
  PrintState current() const { return report_.state; }

 private:
  void acknowledge();
  void count_time();
  void tell();

  const Port& port_;
  const PrintListener& listener_;
  const StreamOptions& options_;
  const RemainingTime remaining_;
  const double began_at_s_;
  PrintReport report_;
  double told_at_s_;
  double printed_s_ = 0;  // in state kPrinting, until counted_at_s_
  double counted_at_s_;
};

}  // namespace packmerger
