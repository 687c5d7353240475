// Real serial ports, opened and configured by libserialport. Reading and writing go to its file
// descriptor: libserialport 0.1.1 reports an unplugged port as a time-out.
#include <libserialport.h>
#include <sys/ioctl.h>
#include <termios.h>

#include "base/error.h"
#include "firmware_io/ports/fd_port.h"

namespace packmerger {

namespace {

struct FreePort {
  void operator()(sp_port* port) const {
    sp_close(port);  // fails harmlessly where it was not open
    sp_free_port(port);
  }
};
using PortHandle = std::unique_ptr<sp_port, FreePort>;

class SerialPort : public FdPort {
 public:
  SerialPort(std::string name, PortHandle handle, int fd, Descriptor lock)
      : FdPort(std::move(name), fd), lock_(std::move(lock)), handle_(std::move(handle)) {}

 private:
  Descriptor lock_;  // declared first: closed last
  PortHandle handle_;
};

std::string last_message() {
  char* text = sp_last_error_message();
  const std::string message = text != nullptr ? text : "unknown error";
  sp_free_error_message(text);
  return message;
}

void configure(sp_port* port, const std::string& name, int baud) {
  if (sp_set_baudrate(port, baud) != SP_OK)
    throw Error(Fault::kUsage,
                "The port " + name + " cannot run at " + std::to_string(baud) + " baud",
                "Set the printer's own baud rate in its profile, such as link.baud = 115200.");
  if (sp_set_bits(port, 8) != SP_OK || sp_set_parity(port, SP_PARITY_NONE) != SP_OK ||
      sp_set_stopbits(port, 1) != SP_OK || sp_set_flowcontrol(port, SP_FLOWCONTROL_NONE) != SP_OK)
    throw Error(Fault::kUnavailable, "Cannot configure the port " + name + ": " + last_message(),
                "Check that it is the port of a printer.");
}

// Closing must not pull DTR down, which resets many boards, and nobody else may open the port.
void keep_to_ourselves(int fd) {
  termios settings{};
  if (::tcgetattr(fd, &settings) == 0) {
    settings.c_cflag &= ~static_cast<tcflag_t>(HUPCL);
    ::tcsetattr(fd, TCSANOW, &settings);
  }
  ::ioctl(fd, TIOCEXCL);
}

}  // namespace

std::unique_ptr<Port> open_serial_port(const std::string& path, const std::string& name, int baud,
                                       Descriptor& lock) {
  sp_port* found = nullptr;
  if (sp_get_port_by_name(path.c_str(), &found) != SP_OK) return nullptr;
  PortHandle handle(found);
  if (sp_open(handle.get(), SP_MODE_READ_WRITE) != SP_OK)
    throw Error(Fault::kUnavailable, "Cannot open the port " + name + ": " + last_message(),
                "Check the cable, the printer's power and the port's name.");
  configure(handle.get(), name, baud);
  int fd = -1;
  if (sp_get_port_handle(handle.get(), &fd) != SP_OK)
    throw Error(Fault::kInternal, "libserialport gives no descriptor for " + name,
                "Report this as a fault of PackMerger.");
  keep_to_ourselves(fd);
  return std::make_unique<SerialPort>(name, std::move(handle), fd, std::move(lock));
}

}  // namespace packmerger
