// Giving a document to a printer of the USB printer class. docs/PROTOCOLS tells the rules and why.
#pragma once

#include <filesystem>

#include "firmware_io/print_state.h"
#include "firmware_io/usb/usb_port.h"

namespace packmerger {

// Sends the file and returns when the printer has taken all of it; what it makes of it, it shows
// itself. options.machine must be part of the maker's and the model's name that it tells. A pause
// holds back the rest of the document. While the printer has no material, is not on line or reports
// an error, nothing is sent and the listener is told (kWaiting); options.timeout_s of that, or of
// no byte taken, ends the print. Progress counts bytes. The file is read as it is sent, 16 KiB at a
// time. Throws
//   Error{kNoInput}      no such file, or an empty one;
//   Error{kUnavailable}  another printer is there, or it was not ready in time to begin with;
//   Error{kIo}           the print failed; what() is the cause. Unless it is gone, the printer was
//                        told to drop what it had (SOFT_RESET);
//   Error{kInterrupted}  cancelled, and the printer was told to drop what it had.
void print_usb(UsbPort& port, const std::filesystem::path& document, const StreamOptions& options,
               const PrintListener& listener, PrintControl& control);

}  // namespace packmerger
