#include "daemon/loop.h"

#include <poll.h>
#include <signal.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <deque>
#include <thread>

#include "base/files.h"
#include "daemon/api.h"
#include "daemon/crew_threads.h"
#include "daemon/foreman.h"
#include "daemon/front_desk.h"
#include "daemon/job_view.h"
#include "daemon/move_file.h"
#include "daemon/news.h"
#include "daemon/reload.h"
#include "daemon/service_manager.h"
#include "daemon/socket_server.h"
#include "daemon/state_lock.h"
#include "daemon/watch_folder.h"

namespace packmerger {
namespace {

using Log = std::function<void(const std::string&)>;

constexpr double kTick_s = 1;
constexpr double kTakeFor_s = 0.05;  // files of one folder in one turn

double now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// SIGTERM, SIGINT and SIGHUP as something to poll for. Threads started later inherit the mask.
class Signals {
 public:
  Signals() {
    ::sigemptyset(&set_);
    for (const int number : {SIGTERM, SIGINT, SIGHUP}) ::sigaddset(&set_, number);
    ::pthread_sigmask(SIG_BLOCK, &set_, nullptr);
    fd_ = ::signalfd(-1, &set_, SFD_CLOEXEC | SFD_NONBLOCK);
  }
  Signals(const Signals&) = delete;
  Signals& operator=(const Signals&) = delete;
  ~Signals() { ::close(fd_); }

  int fd() const { return fd_; }
  // The one that came; 0: none.
  int next() {
    signalfd_siginfo signal;
    return ::read(fd_, &signal, sizeof signal) == sizeof signal ? static_cast<int>(signal.ssi_signo)
                                                                : 0;
  }
  // From now on SIGTERM and SIGINT end the process; there is nothing left to reload.
  void let_through() {
    ::sigdelset(&set_, SIGHUP);
    ::pthread_sigmask(SIG_UNBLOCK, &set_, nullptr);
  }

 private:
  sigset_t set_;
  int fd_ = -1;
};

// A printer's folder. One that cannot be watched (a share that is not mounted) is tried again.
struct Watch {
  PrinterConfig printer;
  std::unique_ptr<WatchFolder> folder = {};
  std::deque<fs::path> whole = {};  // files to take, oldest first
  double retry_s = 0;
  std::string told = {};  // the last trouble, told once
};

class Loop {
 public:
  Loop(const DaemonConfig& config, Foreman& foreman, Queue<Event>& events, SocketServer& server,
       FrontDesk& desk, News& news, ServiceManager& manager, Reload& reload, const Log& log)
      : config_(config),
        foreman_(foreman),
        events_(events),
        server_(server),
        desk_(desk),
        news_(news),
        manager_(manager),
        reload_(reload),
        log_(log) {
    for (const PrinterConfig& printer : config.printers) watches_.push_back({.printer = printer});
  }

  void run(Signals& signals) {
    for (int signal = 0; signal == 0 || signal == SIGHUP; signal = signals.next()) {
      if (signal == SIGHUP) reload();
      const double now = now_s();
      try {
        take_events();
        exchange_printers();
        look_into_folders(now);
        foreman_.advance(now);
        told_.clear();
      } catch (const Error& error) {
        tell(told_, error.what() + (". " + error.hint()));
      }
      server_.serve(now_s());
      desk_.serve(now_s());
      news_.serve(now_s());
      manager_.status(daemon_status(foreman_));
      manager_.alive(now_s());
      wait(signals);
    }
  }

  // An event that could not be recorded stays the first.
  void take_events() {
    while (std::optional<Event> event = events_.try_pop()) unhandled_.push_back(std::move(*event));
    while (!unhandled_.empty()) {
      foreman_.handle(unhandled_.front());
      unhandled_.pop_front();
    }
  }

 private:
  void tell(std::string& told, const std::string& text) {
    if (told != text) log_(text);
    told = text;
  }

  void reload() {
    manager_.reloading();
    const WatchConfig rules = config_.watch;
    reload_.read();
    if (rules != config_.watch)
      for (Watch& watch : watches_) {
        watch.folder.reset();
        watch.whole.clear();
      }
    manager_.ready();
  }

  void exchange_printers() {
    for (const std::string& name : reload_.exchange_printers()) {
      std::erase_if(watches_, [&](const Watch& watch) { return watch.printer.name == name; });
      if (const PrinterConfig* printer = config_.printer(name))
        watches_.push_back({.printer = *printer});
    }
  }

  void look_into_folders(double now) {
    for (Watch& watch : watches_) {
      if (watch.retry_s > now) continue;
      if (watch.whole.empty()) look(watch, now);
      take_files(watch);
    }
  }

  // Thousands may arrive at once, and each is written to the disk several times: the others, and
  // whoever asks something meanwhile, get their turn.
  void take_files(Watch& watch) {
    const double until = now_s() + kTakeFor_s;
    try {
      while (!watch.whole.empty() && now_s() < until) {
        const fs::path file = watch.whole.front();
        watch.whole.pop_front();
        if (watch.folder->is_still_whole(file, now_s()) && !foreman_.arrived(watch.printer, file))
          watch.folder->refuse(file, now_s() + config_.retry_s);
      }
    } catch (const Error&) {
      watch.whole.clear();  // the next look finds them again
      throw;
    }
  }

  void look(Watch& watch, double now) {
    try {
      if (!watch.folder)
        watch.folder = std::make_unique<WatchFolder>(watch.printer.folder, config_.watch);
      const WatchFolder::Found found = watch.folder->look(now);
      watch.told.clear();
      for (const WatchFolder::Ignored& ignored : found.ignored) tell_ignored(ignored);
      watch.whole.assign(found.whole.begin(), found.whole.end());
    } catch (const Error& error) {
      tell(watch.told, error.what() + (". " + error.hint()));
      watch.retry_s = now + config_.retry_s;
    }
  }

  void tell_ignored(const WatchFolder::Ignored& ignored) {
    const std::string text =
        printable(ignored.path.filename().string()) + ": not taken, " + ignored.reason;
    log_(printable(ignored.path.string()) + ": not taken, " + ignored.reason);
    const fs::path failed = ignored.path.parent_path() / "failed";
    try {
      fs::create_directories(failed);
      write_file_whole(note_beside(failed / ignored.path.filename(), ".reason.txt"), text + "\n");
    } catch (const std::exception& error) {
      log_(error.what());
    }
  }

  void wait(const Signals& signals) {
    std::vector<pollfd> waiting = {{signals.fd(), POLLIN, 0}, {events_.fd(), POLLIN, 0}};
    double until = now_s() + kTick_s;
    for (const Watch& watch : watches_) {
      if (!watch.folder) continue;
      if (watch.retry_s <= now_s()) waiting.push_back({watch.folder->fd(), POLLIN, 0});
      const double next_s = watch.whole.empty() ? watch.folder->next_look_s() : 0;
      until = std::min(until, std::max(next_s, watch.retry_s));
    }
    server_.add_to(waiting);
    desk_.add_to(waiting);
    news_.add_to(waiting);
    if (!unhandled_.empty()) std::this_thread::sleep_for(std::chrono::milliseconds(200));
    const int timeout_ms = std::max(0, static_cast<int>(1000 * (until - now_s()))) + 1;
    ::poll(waiting.data(), waiting.size(), timeout_ms);
  }

  const DaemonConfig& config_;
  Foreman& foreman_;
  Queue<Event>& events_;
  SocketServer& server_;
  FrontDesk& desk_;
  News& news_;
  ServiceManager& manager_;
  Reload& reload_;
  const Log& log_;
  std::vector<Watch> watches_;
  std::deque<Event> unhandled_;
  std::string told_;  // what went wrong in the last round, told once
};

void make_state_folder(const fs::path& state) {
  std::error_code failed;
  fs::create_directories(state / "jobs", failed);
  if (failed)
    throw Error(Fault::kCannotWrite,
                "Cannot make the state folder " + state.string() + ": " + failed.message(),
                "Name another one in the settings (state), or make it writable.");
}

}  // namespace

void run_daemon(const std::function<DaemonConfig()>& read, const Log& log) {
  DaemonConfig config = read();
  make_state_folder(config.state);
  const StateLock lock(config.state);
  Signals signals;
  JobStore store(config.state / "jobs.sqlite");
  Queue<Event> events;
  Crew crew(config);
  KeyRing keys(config.state / "keys.json");
  Foreman foreman(config, store, crew, log);
  foreman.recover();
  CrewThreads threads(config.printers, crew, events);
  {
    SocketServer server(config.socket, config.socket_mode,
                        [&](std::string_view request) { return answer(foreman, keys, request); });
    FrontDesk desk(config, foreman, keys, log);
    News news(config, foreman, store, log);
    ServiceManager manager;
    Reload reload(config, read, foreman, threads, log);
    Loop loop(config, foreman, events, server, desk, news, manager, reload, log);
    log("listening at " + config.socket.string());
    if (config.printers.empty())
      log("no printer is configured: add a table [printer.NAME] to the settings, and reload them");
    manager.ready();
    loop.run(signals);
    log("ending");
    manager.stopping();
    signals.let_through();
    foreman.stop();
    threads.finish([&] { manager.alive(now_s()); });
    loop.take_events();
  }
  log("ended");
}

}  // namespace packmerger
