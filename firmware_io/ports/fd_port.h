// A byte channel over an open descriptor: what serial ports, terminals and sockets have in common.
#pragma once

#include <string>

#include "base/descriptor.h"
#include "firmware_io/ports/port.h"

namespace packmerger {

// Reads and writes a configured, non-blocking descriptor; does not close it.
class FdPort : public Port {
 public:
  std::size_t read(char* data, std::size_t size, double timeout_s) override;
  std::size_t write(std::string_view bytes, double timeout_s) override;
  std::string name() const override { return name_; }

 protected:
  FdPort(std::string name, int fd) : name_(std::move(name)), fd_(fd) {}

 private:
  // As write(2).
  virtual ssize_t put(std::string_view bytes);
  bool wait(short events, double timeout_s) const;

  std::string name_;
  int fd_;
};

inline constexpr const char* kTcpPrefix = "tcp:";

[[noreturn]] void throw_busy(const std::string& address);
[[noreturn]] void throw_gone(const std::string& address);

// The first two take the locked port and throw as open_port() does. `path` is resolved, `name` is
// for people. open_serial_port returns nothing where libserialport does not take the terminal for a
// serial port.
std::unique_ptr<Port> open_serial_port(const std::string& path, const std::string& name, int baud,
                                       Descriptor& lock);
std::unique_ptr<Port> open_termios_port(const std::string& name, int baud, Descriptor lock);
std::unique_ptr<Port> open_tcp_port(const std::string& address);

}  // namespace packmerger
