// Printers behind a serial server (ser2net and the like): raw TCP, the bytes as they are. The
// server sets the baud rate.
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstring>

#include "base/error.h"
#include "firmware_io/ports/fd_port.h"

namespace packmerger {

namespace {

constexpr int kConnect_ms = 5000;
// A dead line is noticed within five seconds: by what was sent and not acknowledged, or, where
// nothing is on its way, by probes.
constexpr int kUnacknowledged_ms = 4000;
constexpr int kProbeAfter_s = 2;
constexpr int kProbeEvery_s = 1;
constexpr int kProbes = 2;

struct HostAndService {
  std::string host;
  std::string service;
};

HostAndService parsed(const std::string& address) {
  const std::string rest = address.substr(std::string(kTcpPrefix).size());
  const std::size_t colon = rest.rfind(':');
  HostAndService parts;
  if (colon != std::string::npos) {
    parts = {rest.substr(0, colon), rest.substr(colon + 1)};
    const bool in_brackets =
        parts.host.size() > 2 && parts.host.front() == '[' && parts.host.back() == ']';
    if (in_brackets) parts.host = parts.host.substr(1, parts.host.size() - 2);
  }
  const bool is_number = !parts.service.empty() && parts.service.size() <= 5 &&
                         parts.service.find_first_not_of("0123456789") == std::string::npos;
  if (parts.host.empty() || !is_number || std::stoi(parts.service) > 65535)
    throw Error(Fault::kUsage, address + " is no address of a serial server",
                "Write it as tcp:HOST:PORT, such as tcp:192.168.1.20:2001 or tcp:[::1]:2001.");
  return parts;
}

struct FreeAddresses {
  void operator()(addrinfo* list) const { ::freeaddrinfo(list); }
};
using Addresses = std::unique_ptr<addrinfo, FreeAddresses>;

Addresses looked_up(const std::string& address) {
  const HostAndService parts = parsed(address);
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = AI_NUMERICSERV;
  addrinfo* list = nullptr;
  const int failed = ::getaddrinfo(parts.host.c_str(), parts.service.c_str(), &hints, &list);
  if (failed != 0)
    throw Error(Fault::kUnavailable,
                "Cannot find the serial server " + parts.host + ": " + ::gai_strerror(failed),
                "Check its name and that the network is there.");
  return Addresses(list);
}

// Keeps our own programs from sharing a printer whose server would take two of them. The name is of
// the kernel's and ends with the process, however that ends.
Descriptor locked(const addrinfo& one, const std::string& address) {
  char host[NI_MAXHOST];
  char service[NI_MAXSERV];
  Descriptor lock(::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  const bool named = ::getnameinfo(one.ai_addr, one.ai_addrlen, host, sizeof host, service,
                                   sizeof service, NI_NUMERICHOST | NI_NUMERICSERV) == 0;
  sockaddr_un name{};
  name.sun_family = AF_UNIX;
  std::string text;
  if (named) text = std::string("packmerger-port-") + host + "-" + service;
  text.resize(std::min(text.size(), sizeof name.sun_path - 1));
  std::memcpy(name.sun_path + 1, text.data(), text.size());  // after a zero: no file
  const auto length = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + text.size());
  if (named && lock.get() >= 0 &&
      ::bind(lock.get(), reinterpret_cast<const sockaddr*>(&name), length) == 0)
    return lock;
  if (errno == EADDRINUSE) throw_busy(address);
  throw Error(Fault::kUnavailable, "Cannot lock " + address + ": " + std::strerror(errno),
              "End programs that hold many files, and try again.");
}

// The error, 0 when connected.
int connected(int fd, const addrinfo& one) {
  if (::connect(fd, one.ai_addr, one.ai_addrlen) == 0) return 0;
  if (errno != EINPROGRESS) return errno;
  pollfd entry{fd, POLLOUT, 0};
  int ready = 0;
  do {
    ready = ::poll(&entry, 1, kConnect_ms);
  } while (ready < 0 && errno == EINTR);
  if (ready == 0) return ETIMEDOUT;
  int error = 0;
  socklen_t size = sizeof error;
  if (ready < 0 || ::getsockopt(fd, SOL_SOCKET, SO_ERROR, &error, &size) != 0) return errno;
  return error;
}

void set(int fd, int level, int option, int value) {
  ::setsockopt(fd, level, option, &value, sizeof value);
}

void notice_a_dead_line(int fd) {
  set(fd, SOL_SOCKET, SO_KEEPALIVE, 1);
  set(fd, IPPROTO_TCP, TCP_KEEPIDLE, kProbeAfter_s);
  set(fd, IPPROTO_TCP, TCP_KEEPINTVL, kProbeEvery_s);
  set(fd, IPPROTO_TCP, TCP_KEEPCNT, kProbes);
  set(fd, IPPROTO_TCP, TCP_USER_TIMEOUT, kUnacknowledged_ms);
  set(fd, IPPROTO_TCP, TCP_NODELAY, 1);  // each line waits for its answer
}

class TcpPort : public FdPort {
 public:
  TcpPort(std::string name, Descriptor lock, Descriptor fd)
      : FdPort(std::move(name), fd.get()), lock_(std::move(lock)), fd_(std::move(fd)) {}

 private:
  ssize_t put(std::string_view bytes) override {
    return ::send(fd_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
  }

  Descriptor lock_;  // declared first: closed last
  Descriptor fd_;
};

}  // namespace

std::unique_ptr<Port> open_tcp_port(const std::string& address) {
  const Addresses all = looked_up(address);
  int error = 0;
  for (const addrinfo* one = all.get(); one != nullptr; one = one->ai_next) {
    Descriptor lock = locked(*one, address);
    Descriptor fd(::socket(one->ai_family, one->ai_socktype | SOCK_NONBLOCK | SOCK_CLOEXEC,
                           one->ai_protocol));
    error = fd.get() < 0 ? errno : connected(fd.get(), *one);
    if (error != 0) continue;
    notice_a_dead_line(fd.get());
    return std::make_unique<TcpPort>(address, std::move(lock), std::move(fd));
  }
  throw Error(Fault::kUnavailable, "Cannot connect to " + address + ": " + std::strerror(error),
              "Check that the serial server runs, and that no other program uses the printer.");
}

}  // namespace packmerger
