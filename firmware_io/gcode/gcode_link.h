// Printing G-code on Marlin and its relatives over a byte channel: numbered lines with checksums,
// one outstanding at a time. docs/PROTOCOLS tells the rules and why.
#pragma once

#include <string_view>

#include "firmware_io/ports/port.h"
#include "firmware_io/print_state.h"

namespace packmerger {

// Refuses a program that the wire cannot carry: a command that with a number of eight digits and a
// checksum is longer than 95 bytes (Marlin drops the rest in silence), bytes that are not printable
// ASCII, lines that are numbered already, commands that change the line count (M110), nothing to
// print. Comments and empty lines are not sent and may hold anything. Throws Error{kBadInput}
// naming the line.
void check_gcode(std::string_view program);

// Prints the program and returns when the printer has executed all of it (the last moves too).
// Checks the program first, then asks the printer who it is (M115) and whether it prints from its
// card (M27). A pause begins between two lines: M400, options.pause_gcode; then the printer is
// asked for its temperatures until options.resume_gcode; where one of these is given, the program's
// modes and feed rate are set again. A machine that pauses itself is obeyed. Progress counts the
// program's commands. Throws
//   Error{kBadInput}     as check_gcode;
//   Error{kUnavailable}  nothing that speaks G-code answers, or the printer cannot ask the user
//                        though the program pauses for one (M0, M1);
//   Error{kBusy}         the printer prints from its own card;
//   Error{kIo}           the print failed; what() is the cause. safe_gcode was sent, except where
//                        the printer halted, was reset, stopped at once, or is gone; also when it
//                        was cancelled at the printer, which has then stopped;
//   Error{kInterrupted}  cancelled, and the printer has stopped and executed safe_gcode.
void print_gcode(Port& port, std::string_view program, const StreamOptions& options,
                 const PrintListener& listener, PrintControl& control);

}  // namespace packmerger
