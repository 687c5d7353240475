// What both links share: waiting in short slices so that a cancel acts at once, lines of progress.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "firmware_io/port.h"
#include "firmware_io/print_state.h"

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

// Keeps a print's listener informed: every change of state at once, progress ten times a second.
class Reporter {
 public:
  Reporter(const Port& port, const PrintListener& listener, std::size_t total);

  void state(PrintState state, std::string text = "", std::vector<std::string> choices = {});
  void done(std::size_t done);
  PrintState current() const { return report_.state; }

 private:
  void tell();

  const Port& port_;
  const PrintListener& listener_;
  PrintReport report_;
  double told_at_s_ = 0;
};

}  // namespace packmerger
