#include "bench/paced_line.h"

#include <poll.h>
#include <pty.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

#include "base/error.h"

namespace packmerger::bench {

PacedLine::PacedLine(simulated::Firmware& firmware, double baud, double latency_s)
    : firmware_(firmware), byte_s_(10 / baud), latency_s_(latency_s) {
  termios settings{};
  ::cfmakeraw(&settings);
  int master = -1;
  int slave = -1;
  std::array<char, 128> path;
  if (::openpty(&master, &slave, path.data(), &settings, nullptr) != 0)
    throw Error(Fault::kInternal,
                std::string("Cannot make a pseudo-terminal: ") + std::strerror(errno),
                "Check that /dev/pts is mounted and not full.");
  master_.emplace(master);
  slave_.emplace(slave);
  path_ = path.data();
  thread_ = std::thread([this] { run(); });
}

PacedLine::~PacedLine() {
  stop_ = true;
  thread_.join();
}

double PacedLine::now_s() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - began_).count();
}

void PacedLine::run() {
  while (!stop_) {
    double next_s = std::min(now_s() + 0.02, firmware_.next_event_s());
    if (!coming_.empty()) next_s = std::min(next_s, coming_.front().due_s);
    if (!leaving_.empty()) next_s = std::min(next_s, leaving_.front().due_s);
    wait(next_s);
    take_in();
    deliver(now_s());
  }
}

// Until then, or until the host has written something.
void PacedLine::wait(double until_s) const {
  constexpr double kSpin_s = 0.0003;
  const double left_s = std::max(until_s - now_s() - kSpin_s, 0.0);
  pollfd entry{master_->get(), POLLIN, 0};
  const timespec time{0, static_cast<long>(left_s * 1e9)};
  ::ppoll(&entry, 1, &time, nullptr);
}

void PacedLine::take_in() {
  std::array<char, 4096> bytes;
  pollfd entry{master_->get(), POLLIN, 0};
  if (::poll(&entry, 1, 0) <= 0 || (entry.revents & POLLIN) == 0) return;
  const ssize_t count = ::read(master_->get(), bytes.data(), bytes.size());
  for (ssize_t i = 0; i < count; ++i) {
    in_free_s_ = std::max(in_free_s_, now_s()) + byte_s_;
    coming_.push_back({in_free_s_, std::string(1, bytes[static_cast<std::size_t>(i)])});
  }
}

void PacedLine::deliver(double now_s) {
  while (!coming_.empty() && coming_.front().due_s <= now_s) {
    firmware_.receive(coming_.front().bytes, coming_.front().due_s);
    collect(coming_.front().due_s);
    coming_.pop_front();
  }
  firmware_.advance(now_s);
  collect(now_s);
  while (!leaving_.empty() && leaving_.front().due_s <= now_s) {
    const std::string& bytes = leaving_.front().bytes;
    if (::write(master_->get(), bytes.data(), bytes.size()) < 0) stop_ = true;
    leaving_.pop_front();
  }
}

void PacedLine::collect(double since_s) {
  std::string output = firmware_.take_output();
  if (output.empty()) return;
  out_free_s_ =
      std::max(out_free_s_, since_s + latency_s_) + byte_s_ * static_cast<double>(output.size());
  leaving_.push_back({out_free_s_, std::move(output)});
}

}  // namespace packmerger::bench
