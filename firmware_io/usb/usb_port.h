// A printer of the USB printer class as a byte channel, through libusb.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "firmware_io/ports/devices.h"
#include "firmware_io/ports/port.h"

namespace packmerger {

// Of Port's members: write() returns fewer bytes than it was given, perhaps none, when the time
// passed or the printer stalled; a stall is lifted before it returns, and what was really
// transferred is what counts. read() takes from the printer's way back; where there is none it
// waits for as long. Both throw Error{kIo} once the printer is gone.
class UsbPort : public Port {
 public:
  // The answer to GET_DEVICE_ID, with its length before it; empty where the printer has none.
  virtual std::string device_id() = 0;

  // The answer to GET_PORT_STATUS; nothing where the printer does not tell.
  virtual std::optional<std::uint8_t> port_status() = 0;

  // SOFT_RESET: the printer drops what it was given. Printers were seen that take nothing
  // afterwards until they are opened again, so it belongs to the end of a job that failed.
  virtual void soft_reset() = 0;
};

// Opens the printer and claims its interface of class 7 (protocol 2, both ways, before 1, one way,
// before 3), whose bulk endpoints the descriptors tell. A driver of the kernel that holds it is
// detached, and given back when the port closes. `name`: the address for messages. Throws
// Error{kUnavailable} when it is gone, may not be opened or is no printer, Error{kBusy} when
// another program uses it.
std::unique_ptr<UsbPort> open_usb_port(const UsbDevice& device, const std::string& name);

}  // namespace packmerger
