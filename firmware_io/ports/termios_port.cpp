// Terminals that libserialport refuses: pseudo-terminals, as simulated printers, socat and serial
// servers give. termios2 is used because it takes any baud rate (Marlin's own default is 250000).
#include <asm/termbits.h>
#include <sys/ioctl.h>

#include <cerrno>
#include <cstring>

#include "base/error.h"
#include "firmware_io/ports/fd_port.h"

namespace packmerger {

namespace {

class TermiosPort : public FdPort {
 public:
  TermiosPort(std::string name, Descriptor fd)
      : FdPort(std::move(name), fd.get()), fd_(std::move(fd)) {}

 private:
  Descriptor fd_;
};

void configure(int fd, const std::string& name, int baud) {
  termios2 settings{};
  bool ok = ::ioctl(fd, TCGETS2, &settings) == 0;
  settings.c_iflag = 0;
  settings.c_oflag = 0;
  settings.c_lflag = 0;
  settings.c_cflag = CS8 | CREAD | CLOCAL | BOTHER | (BOTHER << IBSHIFT);  // and so no HUPCL
  settings.c_ispeed = static_cast<speed_t>(baud);
  settings.c_ospeed = static_cast<speed_t>(baud);
  settings.c_cc[VMIN] = 1;
  settings.c_cc[VTIME] = 0;
  ok = ok && ::ioctl(fd, TCSETS2, &settings) == 0;
  if (!ok)
    throw Error(Fault::kUnavailable,
                "Cannot configure the port " + name + ": " + std::strerror(errno),
                "Check that it is the port of a printer.");
}

}  // namespace

// No TIOCEXCL: a pseudo-terminal forgets it only when both its ends are closed, so that a client
// that died would lock the printer for good. The flock that `lock` holds keeps others out.
std::unique_ptr<Port> open_termios_port(const std::string& name, int baud, Descriptor lock) {
  if (baud <= 0)
    throw Error(Fault::kUsage, "No baud rate: " + std::to_string(baud),
                "Set the printer's own baud rate in its profile, such as link.baud = 115200.");
  configure(lock.get(), name, baud);
  ::ioctl(lock.get(), TCFLSH, TCIOFLUSH);
  return std::make_unique<TermiosPort>(name, std::move(lock));
}

}  // namespace packmerger
