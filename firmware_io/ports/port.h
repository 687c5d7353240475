// A byte channel to a printer. Links speak through this interface only, so that the same
// conversation runs over a serial port, a pseudo-terminal, or a scripted channel in tests.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>

namespace packmerger {

// Owned and used by one thread.
class Port {
 public:
  virtual ~Port() = default;

  // Reads at most `size` bytes, waiting up to timeout_s (0: not at all) for the first of them.
  // Returns how many came; 0 when the time passed. Throws Error{kIo} once the other side is gone:
  // unplugged, or its end of the pseudo-terminal closed.
  virtual std::size_t read(char* data, std::size_t size, double timeout_s) = 0;

  // Writes from the front of `bytes`, waiting up to timeout_s for room. Returns how many were
  // taken, which may be fewer than all and 0 when the time passed. Throws as read() does.
  virtual std::size_t write(std::string_view bytes, double timeout_s) = 0;

  // Seconds on the channel's own clock, never going back. A link measures all its waiting by it.
  virtual double now_s() const;

  // The address as the user gave it, for messages.
  virtual std::string name() const = 0;
};

// Opens a serial port: 8 data bits, no parity, one stop bit, no flow control, raw. `address` is a
// device such as /dev/ttyACM0 or a link to one (/dev/serial/by-id/…; it is resolved first). Real
// serial ports go through libserialport; terminals that it refuses (pseudo-terminals) are opened
// through termios. The port is locked against every other program (TIOCEXCL and flock), and
// closing it does not pull DTR down (HUPCL cleared). Opening may reset the printer. tcp:HOST:PORT
// is a serial server (raw TCP, the baud rate is the server's); it is locked against our own
// programs. Throws Error{kUnavailable} when there is no such port or it may not be opened,
// Error{kBusy} when another program holds it, Error{kUsage} for a baud rate that the system does
// not know.
std::unique_ptr<Port> open_port(const std::string& address, int baud);

// Whether an address is that of a serial server, and so of no device.
bool is_tcp(const std::string& address);

}  // namespace packmerger
