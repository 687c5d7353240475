#include "firmware_io/ports/fd_port.h"

#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <utility>

#include "base/error.h"

namespace packmerger {

namespace {

[[noreturn]] void throw_failed(const std::string& name, const char* verb, int error) {
  throw Error(Fault::kIo,
              std::string("Cannot ") + verb + " the port " + name + ": " + std::strerror(error),
              "Check the cable and the printer's power, then print the job again.");
}

// An unplugged serial port reads as the end of a file, a dead pseudo-terminal as EIO; a socket
// tells how its line died.
bool is_gone(int error) {
  for (const int one :
       {EIO, ENXIO, ENODEV, ECONNRESET, EPIPE, ETIMEDOUT, EHOSTUNREACH, ENETUNREACH, ECONNABORTED})
    if (error == one) return true;
  return false;
}

bool try_again(int error) { return error == EAGAIN || error == EWOULDBLOCK || error == EINTR; }

}  // namespace

// True when the descriptor is ready or in a state that the next read or write will tell.
bool FdPort::wait(short events, double timeout_s) const {
  pollfd entry{fd_, events, 0};
  const double ms = std::ceil(std::clamp(timeout_s, 0.0, 3600.0) * 1000);
  const int ready = ::poll(&entry, 1, static_cast<int>(ms));
  if (ready < 0 && errno != EINTR) throw_failed(name_, "wait for", errno);
  // A terminal that was hung up is always ready, so this cannot spin: the caller's read sees it.
  return ready > 0;
}

std::size_t FdPort::read(char* data, std::size_t size, double timeout_s) {
  if (!wait(POLLIN, timeout_s)) return 0;
  const ssize_t count = ::read(fd_, data, size);
  if (count > 0) return static_cast<std::size_t>(count);
  if (count == 0 || is_gone(errno)) throw_gone(name_);
  if (try_again(errno)) return 0;
  throw_failed(name_, "read", errno);
}

ssize_t FdPort::put(std::string_view bytes) { return ::write(fd_, bytes.data(), bytes.size()); }

std::size_t FdPort::write(std::string_view bytes, double timeout_s) {
  while (true) {
    const ssize_t count = put(bytes);
    if (count >= 0) return static_cast<std::size_t>(count);
    if (is_gone(errno)) throw_gone(name_);
    if (!try_again(errno)) throw_failed(name_, "write to", errno);
    if (!wait(POLLOUT, std::exchange(timeout_s, 0))) return 0;
  }
}

}  // namespace packmerger
