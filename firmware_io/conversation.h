// What both links share: waiting in short slices so that a cancel acts at once, lines of progress.
#pragma once

#include <string>
#include <string_view>

#include "firmware_io/port.h"
#include "firmware_io/print_state.h"

namespace packmerger {

// Longest uninterrupted wait of a link; a cancel is seen within it.
inline constexpr double kSlice_s = 0.1;

// Writes all of it. Throws Error{kIo} when the port takes nothing for five seconds.
void write_all(Port& port, std::string_view bytes);

// Keeps a print's listener informed: every change of state at once, progress ten times a second.
class Reporter {
 public:
  Reporter(const Port& port, const PrintListener& listener, std::size_t total);

  void state(PrintState state, std::string text = "");
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
