// Lines of G-code over a port (Marlin's N, checksum and ok; docs/PROTOCOLS), and the first words
// with a printer.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "firmware_io/gcode/gcode.h"
#include "firmware_io/ports/port.h"
#include "firmware_io/print_state.h"

namespace packmerger {

class GcodeChannel {
 public:
  explicit GcodeChannel(Port& port) : port_(port) {}

  // The next reply, waiting at most timeout_s for it. Empty lines are passed over.
  std::optional<GcodeReply> receive(double timeout_s);

  void send(std::string_view line);  // with the line ending
  double now_s() const { return port_.now_s(); }
  std::string name() const { return port_.name(); }

 private:
  std::optional<GcodeReply> take_line();

  Port& port_;
  std::string pending_;      // read, not yet taken
  std::size_t scanned_ = 0;  // of pending_, known to hold no line ending
};

// What the answer to M115 says.
struct GcodeAbilities {
  bool prompts = false;           // asks its user through the host
  bool emergency_parser = false;  // reads M876 while it waits; else only M108 ends the wait
  bool autoreport = false;        // tells its temperatures of its own once it is asked to (M155)
};

// Waits until the board has booted, asks who it is and whether it prints from its card, and sets
// its line count to 0. Throws Error{kUnavailable} (also for the wrong machine), {kBusy}, {kIo}
// (halted) or {kInterrupted}.
GcodeAbilities connect_gcode(GcodeChannel& channel, const StreamOptions& options,
                             const PrintControl& control);

// The end of a print, in the printer's own words. Throws Error{kIo}.
[[noreturn]] void throw_told_failure(const GcodeReply& reply);

}  // namespace packmerger
