// Printing x3g on a MakerBot Replicator and its relatives over the s3g protocol: one packet, one
// reply. docs/PROTOCOLS tells the rules and why.
#pragma once

#include <string_view>

#include "firmware_io/ports/port.h"
#include "firmware_io/print_state.h"

namespace packmerger {

// Refuses what is no x3g program: an action code without a known length (the firmware would accept
// it and go astray), an action that must not be streamed (factory reset), a last action cut short,
// nothing to print. Throws Error{kBadInput} with the offset.
void check_x3g(std::string_view program);

// Prints the program and returns when the printer has executed all of it and says that its build
// is finished. Checks the program first, then the firmware (version query) and its build state.
// The program is sent as it is; only where it has no build start (build end) is one put before
// (after) it, named options.build_name. Progress counts the program's bytes.
// Throws
//   Error{kBadInput}     as check_x3g;
//   Error{kUnavailable}  nothing that speaks s3g answers;
//   Error{kBusy}         the printer is printing already, or prints from its card;
//   Error{kIo}           the print failed, was cancelled at the printer, or the printer shut down
//                        for heat; what() is the cause. The build was aborted where it could be;
//   Error{kInterrupted}  cancelled, and the printer has aborted the build (heaters off).
void print_x3g(Port& port, std::string_view program, const StreamOptions& options,
               const PrintListener& listener, PrintControl& control);

}  // namespace packmerger
