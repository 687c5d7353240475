// Printers behind a serial server: a relay between TCP and a simulated printer's terminal, as
// ser2net is one.
#include <arpa/inet.h>
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>

#include <array>

#include "base/descriptor.h"
#include "firmware_io/ports/port.h"
#include "sim/terminal_printer.h"

namespace packmerger::test {
namespace {

using ::testing::HasSubstr;

// Takes one client at a time; drop() ends its connection.
class SerialServer {
 public:
  explicit SerialServer(const std::string& terminal)
      : terminal_(::open(terminal.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC)),
        listener_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in at{};
    at.sin_family = AF_INET;
    at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof at;
    auto* address = reinterpret_cast<sockaddr*>(&at);
    if (::bind(listener_.get(), address, size) != 0 || ::listen(listener_.get(), 1) != 0 ||
        ::getsockname(listener_.get(), address, &size) != 0)
      throw std::runtime_error("no listening socket");
    port_ = ntohs(at.sin_port);
    thread_ = std::thread([this] {
      while (!stop_) serve();
    });
  }
  SerialServer(const SerialServer&) = delete;
  SerialServer& operator=(const SerialServer&) = delete;
  ~SerialServer() {
    stop_ = true;
    thread_.join();
  }

  std::string address() const { return "tcp:127.0.0.1:" + std::to_string(port_); }
  void drop() { dropped_ = true; }

 private:
  static constexpr int kSlice_ms = 20;

  void serve() {
    pollfd entry{listener_.get(), POLLIN, 0};
    if (::poll(&entry, 1, kSlice_ms) <= 0) return;
    const Descriptor client(::accept4(listener_.get(), nullptr, nullptr, SOCK_CLOEXEC));
    dropped_ = false;
    while (!stop_ && !dropped_ && relay(client.get())) {
    }
  }

  // False once the client has gone.
  bool relay(int client) const {
    std::array<pollfd, 2> both{{{client, POLLIN, 0}, {terminal_.get(), POLLIN, 0}}};
    ::poll(both.data(), both.size(), kSlice_ms);
    if (both[0].revents != 0 && !passed(client, terminal_.get())) return false;
    if (both[1].revents != 0) passed(terminal_.get(), client);
    return true;
  }

  static bool passed(int from, int to) {
    std::array<char, 4096> bytes;
    const ssize_t count = ::read(from, bytes.data(), bytes.size());
    for (ssize_t done = 0; done < count;) {
      const auto rest = static_cast<std::size_t>(count - done);
      const ssize_t more = ::write(to, bytes.data() + done, rest);
      if (more > 0) done += more;
    }
    return count > 0;
  }

  Descriptor terminal_;
  Descriptor listener_;
  int port_ = 0;
  std::atomic<bool> stop_{false};
  std::atomic<bool> dropped_{false};
  std::thread thread_;
};

Error refusal(const std::string& address) {
  try {
    open_port(address, 115200);
  } catch (const Error& error) {
    return error;
  }
  throw std::runtime_error(address + " was opened");
}

TEST(SerialServers, PrinterExecutesTheProgram) {
  Printer printer(Machine::kMarlin, 0);
  const SerialServer server(printer.path());
  PrintControl control;
  for (int i = 0; i < 2; ++i) {
    const auto failure =
        print(Machine::kMarlin, server.address(), program_of(Machine::kMarlin, 2000), control);
    EXPECT_FALSE(failure) << failure->what();
  }
  std::vector<std::string> twice = executed_by_marlin(2000);
  const std::vector<std::string> once = twice;
  twice.insert(twice.end(), once.begin(), once.end());
  EXPECT_EQ(without_questions(printer.record()), twice);
}

TEST(SerialServers, LostConnectionFailsSoonAndTheNextPrintRuns) {
  Printer printer(Machine::kReplicator, 10);
  SerialServer server(printer.path());
  expect_failure_soon(Machine::kReplicator, server.address(), [&] { server.drop(); });
  EXPECT_NO_THROW(open_port(server.address(), 115200));
}

TEST(SerialServers, SecondOpenerIsRefused) {
  Printer printer(Machine::kMarlin, 0);
  const SerialServer server(printer.path());
  const auto port = open_port(server.address(), 115200);
  const Error error = refusal(server.address());
  EXPECT_EQ(error.fault(), Fault::kBusy);
  EXPECT_THAT(error.what(), HasSubstr(server.address()));
}

TEST(SerialServers, NobodyListens) {
  std::string address;
  {
    Printer printer(Machine::kMarlin, 0);
    address = SerialServer(printer.path()).address();
  }
  const Error error = refusal(address);
  EXPECT_EQ(error.fault(), Fault::kUnavailable);
  EXPECT_THAT(error.what(), HasSubstr("Connection refused"));
  EXPECT_FALSE(error.hint().empty());
}

TEST(SerialServers, WhatIsNoAddress) {
  for (const char* address : {"tcp:", "tcp:host", "tcp::2001", "tcp:host:", "tcp:host:x1",
                              "tcp:host:65536", "tcp:host:-1", "tcp:host:123456"}) {
    const Error error = refusal(address);
    EXPECT_EQ(error.fault(), Fault::kUsage) << address;
    EXPECT_THAT(error.hint(), HasSubstr("tcp:HOST:PORT")) << address;
  }
}

}  // namespace
}  // namespace packmerger::test
