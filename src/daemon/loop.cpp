#include "daemon/loop.h"

#include <poll.h>
#include <signal.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <deque>
#include <exception>
#include <limits>
#include <map>
#include <thread>

#include "base/files.h"
#include "base/names.h"
#include "base/time/backoff.h"
#include "base/time/clock.h"
#include "daemon/jobs/job_manager.h"
#include "daemon/local/api.h"
#include "daemon/local/socket_server.h"
#include "daemon/notifier.h"
#include "daemon/reload.h"
#include "daemon/room_to_start.h"
#include "daemon/service_manager.h"
#include "daemon/settings/workers.h"
#include "daemon/state_folder.h"
#include "daemon/state_lock.h"
#include "daemon/views/daemon_view.h"
#include "daemon/web/web_service.h"
#include "daemon/workers/worker_threads.h"

namespace packmerger {
namespace {

using Log = std::function<void(const std::string&)>;

constexpr int kTick_ms = 1000;
constexpr double kHandleFor_s = 0.05;                  // events in one turn
constexpr std::chrono::milliseconds kFirstPause(200);  // after what failed

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

class Loop {
 public:
  Loop(const DaemonConfig& config, JobManager& job_manager, WorkQueues& queues,
       WorkerThreads& threads, Queue<Event>& events, SocketServer& server, WebService& web,
       Notifier& notifier, ServiceManager& manager, Reload& reload, const Log& log)
      : config_(config),
        job_manager_(job_manager),
        queues_(queues),
        threads_(threads),
        events_(events),
        server_(server),
        web_(web),
        notifier_(notifier),
        manager_(manager),
        reload_(reload),
        log_(log) {
    for (const PrinterConfig& printer : config.printers) watch(printer);
  }

  void run(Signals& signals) {
    for (int signal = 0; signal == 0 || signal == SIGHUP; signal = signals.next()) {
      if (signal == SIGHUP) reload();
      const double now_s = steady_now_s();
      collect_events();
      guarded(cleaning_, now_s, [&] { job_manager_.clean(now_s); });
      guarded(jobs_, now_s, [&] {
        take_events(now_s + kHandleFor_s);
        exchange_printers();
        job_manager_.advance(now_s);
      });
      guarded(doors_, now_s, [&] {
        threads_.start_folder_workers();
        server_.serve(now_s);
        web_.serve(now_s);
        notifier_.serve(now_s);
        manager_.status(daemon_status(job_manager_));
      });
      manager_.alive(now_s);
      wait(signals);
    }
  }

  void take_all_events() {
    collect_events();
    take_events(std::numeric_limits<double>::infinity());
  }

 private:
  // What a round does with old jobs' folders, with the jobs and their database, and with whoever
  // asks.
  struct Part {
    const char* about;
    int most_doublings = 0;  // of the pause after a failure
    std::string told = {};
    int failures = 0;
    double retry_s = 0;
    Standing standing = {};
  };

  // What goes wrong is told once, and tried again later: a disk that is full is not asked in each
  // round.
  void guarded(Part& part, double now_s, const std::function<void()>& work) {
    if (now_s < part.retry_s) return;
    std::string trouble;
    try {
      work();
    } catch (const Error& error) {
      trouble = error.what() + (". " + error.hint());
    } catch (const std::exception& error) {
      trouble = error.what();
    }
    if (!trouble.empty() && part.told != trouble) log_(trouble);
    part.told = trouble;
    if (trouble.empty()) {
      part.failures = 0;
      if (part.standing.trouble()) part.standing.works();
    } else {
      const double pause_s = backoff_s(std::chrono::duration<double>(kFirstPause).count(),
                                       part.failures++, part.most_doublings);
      part.retry_s = steady_now_s() + pause_s;
      part.standing.failed(printable(trouble), pause_s);
    }
    Troubles troubles;
    if (const auto now = part.standing.trouble()) troubles[part.about] = *now;
    job_manager_.note_troubles(part.about, std::move(troubles));
  }

  // What was deleted waits for nothing: the room it made may be what the others cannot be recorded
  // without.
  void collect_events() {
    while (std::optional<Event> event = events_.try_pop())
      if (std::holds_alternative<Deleted>(*event))
        job_manager_.handle(*event);
      else
        unhandled_.push_back(std::move(*event));
  }

  // An event that could not be recorded stays the first. Thousands may come at once, and each is
  // written to the disk several times: whoever asks something meanwhile gets a turn.
  void take_events(double until_s) {
    while (!unhandled_.empty() && steady_now_s() < until_s) {
      job_manager_.handle(unhandled_.front());
      unhandled_.pop_front();
    }
  }

  void reload() {
    manager_.reloading();
    const WatchConfig rules = config_.watch;
    const double retry_s = config_.retry_s;
    reload_.read();
    threads_.start_workers(workers_of(config_.prepare));
    if (rules != config_.watch || retry_s != config_.retry_s)
      for (const PrinterConfig& printer : config_.printers) watch(printer);
    manager_.ready();
  }

  // Two printers may have exchanged their folders.
  void exchange_printers() {
    const std::vector<std::string> changed = reload_.exchange_printers();
    for (const std::string& name : changed)
      if (const auto found = watched_.find(name); found != watched_.end()) {
        queues_.folders[found->second].orders.push(WatchOrder{});
        watched_.erase(found);
      }
    for (const std::string& name : changed)
      if (const PrinterConfig* printer = config_.printer(name)) watch(*printer);
  }

  void watch(const PrinterConfig& printer) {
    watched_[printer.name] = printer.folder;
    queues_.folders[printer.folder].orders.push(
        WatchOrder{printer.name, config_.watch, config_.retry_s});
  }

  void wait(const Signals& signals) {
    std::vector<pollfd> waiting = {{signals.fd(), POLLIN, 0}, {events_.fd(), POLLIN, 0}};
    server_.add_to(waiting);
    web_.add_to(waiting);
    notifier_.add_to(waiting);
    // whoever stands at a door that fails would wake this at once
    if (doors_.failures > 0) std::this_thread::sleep_for(kFirstPause);
    int pause_ms = unhandled_.empty() ? kTick_ms : 0;
    if (jobs_.failures > 0)
      pause_ms = std::clamp(static_cast<int>(1000 * (jobs_.retry_s - steady_now_s())), 1, kTick_ms);
    ::poll(waiting.data(), waiting.size(), pause_ms);
  }

  const DaemonConfig& config_;
  JobManager& job_manager_;
  WorkQueues& queues_;
  WorkerThreads& threads_;
  Queue<Event>& events_;
  SocketServer& server_;
  WebService& web_;
  Notifier& notifier_;
  ServiceManager& manager_;
  Reload& reload_;
  const Log& log_;
  std::map<std::string, fs::path> watched_;  // by printer
  std::deque<Event> unhandled_;
  Part cleaning_{"deleting old jobs", 7};
  Part jobs_{"the jobs' database", 5};
  Part doors_{"socket and web server"};
};

std::exception_ptr caught(const std::function<void()>& work, const Log& log) {
  try {
    work();
    return nullptr;
  } catch (const std::exception& error) {
    log(std::string("error: ") + error.what());
    return std::current_exception();
  }
}

}  // namespace

void run_daemon(const std::function<DaemonConfig()>& read, const Log& log) {
  DaemonConfig config = read();
  const std::vector<std::string> told = furnish_state_folder(config.state);
  const StateLock lock(config.state);
  for (const std::string& line : told) log(line);
  Signals signals;
  Deleted cleared = make_room_to_start(config.state, log);
  JobStore store(config.state / "jobs.sqlite");
  Queue<Event> events;
  if (!cleared.jobs.empty()) events.push(std::move(cleared));
  WorkQueues queues(config);
  KeyRing keys(config.state / "keys.json");
  JobManager job_manager(config, store, queues, log);
  job_manager.recover();
  WorkerThreads threads(config, queues, events);
  std::exception_ptr escaped;
  std::vector<std::string> hanging;
  {
    SocketServer server(config.socket, config.socket_mode, [&](std::string_view request) {
      return answer(job_manager, keys, request);
    });
    WebService web(config, job_manager, keys, log);
    Notifier notifier(config, job_manager, store, log);
    ServiceManager manager;
    Reload reload(config, read, job_manager, threads, log);
    Loop loop(config, job_manager, queues, threads, events, server, web, notifier, manager, reload,
              log);
    log("listening at " + config.socket.string());
    if (config.printers.empty())
      log("no printer is configured: add a table [printer.NAME] to the settings, and reload them");
    manager.ready();
    // whatever happens, a print is not left alone with hot heaters
    escaped = caught([&] { loop.run(signals); }, log);
    log("ending");
    manager.stopping();
    signals.let_through();
    job_manager.stop();
    hanging = threads.finish([&] { manager.alive(steady_now_s()); });
    const std::exception_ptr unrecorded = caught([&] { loop.take_all_events(); }, log);
    if (!escaped) escaped = unrecorded;
  }
  for (const std::string& folder : hanging)
    log(folder + " does not answer; what was under way there was left");
  log("ended");
  if (!hanging.empty()) std::_Exit(escaped ? static_cast<int>(Fault::kInternal) : 0);
  if (escaped) std::rethrow_exception(escaped);
}

}  // namespace packmerger
