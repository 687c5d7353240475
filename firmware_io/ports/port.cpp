#include "firmware_io/ports/port.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <climits>
#include <cstdlib>
#include <cstring>

#include "base/error.h"
#include "base/time/clock.h"
#include "firmware_io/ports/fd_port.h"

namespace packmerger {

namespace {

[[noreturn]] void throw_unavailable(const std::string& address, int error) {
  const std::string hint =
      error == EACCES ? "Add your user to the group that owns the port (on Debian: dialout)."
                      : "Check the cable, the printer's power and the port's name.";
  throw Error(Fault::kUnavailable, "Cannot open the port " + address + ": " + std::strerror(error),
              hint);
}

// libserialport knows a port by its real name only, and so does the lock.
std::string resolve(const std::string& address) {
  char path[PATH_MAX];
  if (::realpath(address.c_str(), path) == nullptr) throw_unavailable(address, errno);
  return path;
}

// Opening a port that another program holds must not touch its modem lines, so the lock comes
// before anything else: a second open of a port that is open already moves no line.
Descriptor lock_port(const std::string& path, const std::string& address) {
  Descriptor lock(::open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  if (lock.get() < 0) {
    if (errno == EBUSY) throw_busy(address);
    throw_unavailable(address, errno);
  }
  struct stat status {};
  if (::fstat(lock.get(), &status) != 0 || !S_ISCHR(status.st_mode) || !::isatty(lock.get()))
    throw Error(Fault::kUnavailable, address + " is no serial port",
                "Give the device of a printer, such as /dev/ttyACM0.");
  if (::flock(lock.get(), LOCK_EX | LOCK_NB) != 0) {
    if (errno == EWOULDBLOCK) throw_busy(address);
    throw_unavailable(address, errno);
  }
  return lock;
}

}  // namespace

double Port::now_s() const { return steady_now_s(); }

void throw_busy(const std::string& address) {
  throw Error(Fault::kBusy, "The port " + address + " is held by another program",
              "End the program that uses the printer, or wait until its print is done.");
}

void throw_gone(const std::string& address) {
  throw Error(Fault::kIo, "The printer at " + address + " is gone",
              "Check the cable and the printer's power, then print the job again.");
}

bool is_tcp(const std::string& address) { return address.starts_with(kTcpPrefix); }

std::unique_ptr<Port> open_port(const std::string& address, int baud) {
  if (is_tcp(address)) return open_tcp_port(address);
  const std::string path = resolve(address);
  Descriptor lock = lock_port(path, address);
  if (auto port = open_serial_port(path, address, baud, lock)) return port;
  return open_termios_port(address, baud, std::move(lock));
}

}  // namespace packmerger
