// A simulated firmware on a pseudo-terminal, in real time.
#include <fcntl.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <cstring>

#include "base/error.h"
#include "firmware_io/ports/fd_port.h"
#include "firmware_io/simulated/marlin.h"
#include "firmware_io/simulated/replicator.h"
#include "firmware_io/simulated/simulator.h"

namespace packmerger {

namespace {

using simulated::Firmware;
using simulated::Pace;

// How soon a stop is obeyed and a client that opens the terminal is seen.
constexpr double kSlice_s = 0.02;
// More than a client that does not read may be behind.
constexpr std::size_t kMaxUnread = 65536;

[[noreturn]] void throw_no_terminal() {
  throw Error(Fault::kInternal,
              std::string("Cannot make a pseudo-terminal: ") + std::strerror(errno),
              "Check that /dev/pts is mounted and not full.");
}

struct Terminal {
  Descriptor master;
  std::string path;
};

Terminal make_terminal() {
  Descriptor master(::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  char path[128];
  const bool ok = master.get() >= 0 && ::grantpt(master.get()) == 0 &&
                  ::unlockpt(master.get()) == 0 &&
                  ::ptsname_r(master.get(), path, sizeof path) == 0;
  if (!ok) throw_no_terminal();
  // A client that writes before it has configured the terminal must not hear its own echo.
  const Descriptor slave(::open(path, O_RDWR | O_NOCTTY | O_CLOEXEC));
  termios settings{};
  if (slave.get() < 0 || ::tcgetattr(slave.get(), &settings) != 0) throw_no_terminal();
  ::cfmakeraw(&settings);
  if (::tcsetattr(slave.get(), TCSANOW, &settings) != 0) throw_no_terminal();
  return {std::move(master), path};
}

class Record {
 public:
  explicit Record(std::filesystem::path path) : path_(std::move(path)) {
    if (path_.empty()) return;
    fd_ = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (fd_ < 0) fail();
  }
  Record(const Record&) = delete;
  Record& operator=(const Record&) = delete;
  ~Record() {
    if (fd_ >= 0) ::close(fd_);
  }

  // Written before the answers go out: a client that was told "done" finds everything recorded.
  void add(const std::vector<std::string>& lines) const {
    if (fd_ < 0 || lines.empty()) return;
    std::string text;
    for (const std::string& line : lines) text += line + "\n";
    for (std::string_view rest = text; !rest.empty();) {
      const ssize_t count = ::write(fd_, rest.data(), rest.size());
      if (count < 0 && errno != EINTR) fail();
      if (count > 0) rest.remove_prefix(static_cast<std::size_t>(count));
    }
  }

 private:
  [[noreturn]] void fail() const {
    throw Error(Fault::kCannotWrite, "Cannot write " + path_.string() + ": " + std::strerror(errno),
                "Choose another place for the record.");
  }

  std::filesystem::path path_;
  int fd_ = -1;
};

class Session {
 public:
  Session(Firmware& firmware, const SimulatorOptions& options)
      : firmware_(firmware),
        rate_(options.speed > 0 ? options.speed : 1),
        record_(options.record),
        terminal_(make_terminal()) {}

  const std::string& path() const { return terminal_.path; }

  void step() {
    const bool connected = wait();
    if (connected) read();
    firmware_.advance(now_s());
    record_.add(firmware_.take_executed());
    unread_ += firmware_.take_output();
    if (unread_.size() > kMaxUnread || !connected) unread_.clear();
    write();
  }

 private:
  double now_s() const {
    return rate_ * std::chrono::duration<double>(std::chrono::steady_clock::now() - began_).count();
  }

  // False while no client has the terminal open.
  bool wait() const {
    const double until_event_s = (firmware_.next_event_s() - now_s()) / rate_;
    const double wait_s = std::clamp(until_event_s, 0.0, kSlice_s);
    pollfd entry{terminal_.master.get(), POLLIN, 0};
    if (!unread_.empty()) entry.events |= POLLOUT;
    ::poll(&entry, 1, static_cast<int>(std::ceil(wait_s * 1000)));
    const bool hung_up = (entry.revents & POLLHUP) != 0 && (entry.revents & POLLIN) == 0;
    // Such a terminal is always ready; without a pause we would spin.
    if (hung_up) ::usleep(static_cast<useconds_t>(wait_s * 1e6));
    return !hung_up;
  }

  void read() {
    char bytes[4096];
    const ssize_t count = ::read(terminal_.master.get(), bytes, sizeof bytes);
    if (count > 0) firmware_.receive({bytes, static_cast<std::size_t>(count)}, now_s());
  }

  void write() {
    if (unread_.empty()) return;
    const ssize_t count = ::write(terminal_.master.get(), unread_.data(), unread_.size());
    if (count > 0) unread_.erase(0, static_cast<std::size_t>(count));
  }

  Firmware& firmware_;
  double rate_;
  Record record_;
  Terminal terminal_;
  std::chrono::steady_clock::time_point began_ = std::chrono::steady_clock::now();
  std::string unread_;
};

void run(Firmware& firmware, const SimulatorOptions& options, const ListeningAt& listening,
         const std::atomic<bool>& stop) {
  Session session(firmware, options);
  listening(session.path());
  while (!stop) session.step();
}

Pace pace_of(const SimulatorOptions& options) {
  return options.speed > 0 ? Pace{options.speed, false} : Pace{1, true};
}

}  // namespace

void run_simulated_replicator(const SimulatorOptions& options,
                              const simulated::ReplicatorTraits& traits,
                              const ListeningAt& listening, const std::atomic<bool>& stop) {
  simulated::Replicator firmware(pace_of(options), traits);
  run(firmware, options, listening, stop);
}

void run_simulated_marlin(const SimulatorOptions& options, const simulated::MarlinTraits& traits,
                          const ListeningAt& listening, const std::atomic<bool>& stop) {
  simulated::Marlin firmware(pace_of(options), traits);
  run(firmware, options, listening, stop);
}

}  // namespace packmerger
