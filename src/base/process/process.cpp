#include "base/process/process.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <utility>

#include "base/error.h"
#include "base/process/confinement.h"
#include "base/remains.h"

namespace packmerger {
namespace {

using Clock = std::chrono::steady_clock;

std::vector<std::string> environment_of(const ProcessSpec& spec) {
  std::map<std::string, std::string> values;
  for (char** entry = environ; *entry != nullptr; ++entry) {
    const std::string_view text = *entry;
    const std::size_t equals = text.find('=');
    if (equals != std::string_view::npos)
      values.emplace(text.substr(0, equals), text.substr(equals + 1));
  }
  for (const auto& [name, value] : spec.set_env) values[name] = value;
  for (const std::string& name : spec.unset_env) values.erase(name);
  std::vector<std::string> lines;
  for (const auto& [name, value] : values) lines.push_back(name + "=" + value);
  return lines;
}

std::vector<char*> pointers(std::vector<std::string>& lines) {
  std::vector<char*> result;
  for (std::string& line : lines) result.push_back(line.data());
  result.push_back(nullptr);
  return result;
}

struct Pipe {
  int read = -1;
  int write = -1;
  Pipe() {
    std::array<int, 2> ends{};
    if (::pipe2(ends.data(), O_CLOEXEC) != 0)
      throw Error(Fault::kInternal, std::string("Cannot make a pipe: ") + std::strerror(errno),
                  "Close other programs and try again.");
    read = ends[0];
    write = ends[1];
  }
  ~Pipe() {
    if (read >= 0) ::close(read);
    if (write >= 0) ::close(write);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
};

// Runs in the child between fork and exec: only async-signal-safe calls.
[[noreturn]] void become(const ProcessSpec& spec, const Confinement* confinement, char* const* argv,
                         char* const* envp, const Pipe& out, const Pipe& err, const Pipe& failure,
                         pid_t parent) {
  if (confinement == nullptr) ::setpgid(0, 0);  // else it leads a session
  ::prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (::getppid() != parent) ::_exit(127);
  for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGPIPE, SIGCHLD}) ::signal(number, SIG_DFL);
  sigset_t none;
  ::sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
  const int null = ::open("/dev/null", O_RDONLY);
  ::dup2(null, 0);
  ::dup2(out.write, 1);
  ::dup2(err.write, 2);
  if (spec.nice != 0) ::setpriority(PRIO_PROCESS, 0, ::getpriority(PRIO_PROCESS, 0) + spec.nice);
  if (spec.max_memory_bytes != 0) {
    rlimit limit{};
    ::getrlimit(RLIMIT_AS, &limit);  // root could raise what an ancestor was allowed
    limit.rlim_max = std::min<rlim_t>(limit.rlim_max, spec.max_memory_bytes);
    limit.rlim_cur = limit.rlim_max;
    if (::setrlimit(RLIMIT_AS, &limit) != 0) ::_exit(127);
  }
  if ((spec.folder.empty() || ::chdir(spec.folder.c_str()) == 0) &&
      (confinement == nullptr || confinement->apply()))
    ::execvpe(argv[0], argv, envp);
  const int reason = errno;
  [[maybe_unused]] const ssize_t told = ::write(failure.write, &reason, sizeof reason);
  ::_exit(127);
}

void forget_group(pid_t group) {
  const std::lock_guard lock(remains().mutex);
  remains().groups.erase(group);
}

// Appends what can be read now, up to `room` bytes in `text`. False at the end of the stream.
bool drain(int fd, std::string& text, std::size_t room) {
  std::array<char, 65536> block;
  for (;;) {
    const ssize_t count = ::read(fd, block.data(), block.size());
    if (count == 0) return false;
    if (count < 0) return errno == EAGAIN || errno == EINTR;
    const std::size_t space = room > text.size() ? room - text.size() : 0;
    text.append(block.data(), std::min(space, static_cast<std::size_t>(count)));
  }
}

}  // namespace

ChildProcess::ChildProcess(const ProcessSpec& spec) {
  std::vector<std::string> arguments = spec.argv;
  std::vector<std::string> environment = environment_of(spec);
  const std::vector<char*> argv = pointers(arguments);
  const std::vector<char*> envp = pointers(environment);
  std::optional<Confinement> confinement;
  if (!spec.only_writable.empty()) confinement.emplace(spec.only_writable);
  Pipe out;
  Pipe err;
  Pipe failure;
  const pid_t parent = ::getpid();
  {
    const std::lock_guard lock(remains().mutex);
    pid_ = ::fork();
    if (pid_ > 0) remains().groups.insert(pid_);
  }
  if (pid_ < 0)
    throw Error(Fault::kInternal, std::string("Cannot start a process: ") + std::strerror(errno),
                "Close other programs and try again.");
  if (pid_ == 0)
    become(spec, confinement ? &*confinement : nullptr, argv.data(), envp.data(), out, err, failure,
           parent);
  ::close(std::exchange(failure.write, -1));
  int cause = 0;
  ssize_t told = 0;
  do {
    told = ::read(failure.read, &cause, sizeof cause);
  } while (told < 0 && errno == EINTR);
  if (told == sizeof cause) {
    ::waitpid(pid_, nullptr, 0);
    forget_group(pid_);
    throw Error(Fault::kUnavailable,
                "Cannot run " + spec.argv.front() + ": " + std::strerror(cause),
                "Install it, or set the PATH so that it is found.");
  }
  out_ = std::exchange(out.read, -1);
  err_ = std::exchange(err.read, -1);
  for (const int fd : {out_, err_}) ::fcntl(fd, F_SETFL, ::fcntl(fd, F_GETFL) | O_NONBLOCK);
}

ChildProcess::~ChildProcess() {
  packmerger::signal_group(pid_, SIGKILL);
  if (!status_) ::waitpid(pid_, nullptr, 0);
  forget_group(pid_);
  ::close(out_);
  ::close(err_);
}

std::optional<ExitStatus> ChildProcess::poll() {
  if (status_) return status_;
  int raw = 0;
  if (::waitpid(pid_, &raw, WNOHANG) != pid_) return std::nullopt;
  status_ = WIFSIGNALED(raw) ? ExitStatus{0, WTERMSIG(raw)} : ExitStatus{WEXITSTATUS(raw), 0};
  return status_;
}

void signal_group(pid_t group, int signal) {
  if (::kill(-group, signal) == 0 || errno != EACCES) return;
  // Who is confined may signal its own group only: a process of ours joins the group.
  const pid_t joining = ::fork();
  if (joining == 0) {
    if (::setpgid(0, group) == 0) ::kill(0, signal);
    ::_exit(0);
  }
  if (joining > 0) ::waitpid(joining, nullptr, 0);
}

ProcessResult run_process(const ProcessSpec& spec, double timeout_s, const Progress& progress,
                          const std::function<void(std::string_view)>& on_err_line,
                          std::size_t max_output) {
  ChildProcess child(spec);
  ProcessResult result;
  const Clock::time_point start = Clock::now();
  const auto seconds = [&] { return std::chrono::duration<double>(Clock::now() - start).count(); };
  std::size_t seen = 0;  // bytes of result.err already given to on_err_line
  const auto tell_lines = [&] {
    if (!on_err_line) return;
    for (std::size_t end = result.err.find('\n', seen); end != std::string::npos;
         end = result.err.find('\n', seen)) {
      on_err_line(std::string_view(result.err).substr(seen, end - seen));
      seen = end + 1;
    }
  };
  bool out_open = true;
  bool err_open = true;
  double kill_at = 0;
  std::optional<Error> cancelled;
  for (;;) {
    std::array<pollfd, 2> watched{pollfd{out_open ? child.out_fd() : -1, POLLIN, 0},
                                  pollfd{err_open ? child.err_fd() : -1, POLLIN, 0}};
    ::poll(watched.data(), watched.size(), 50);
    if (out_open) out_open = drain(child.out_fd(), result.out, max_output);
    if (err_open) err_open = drain(child.err_fd(), result.err, max_output);
    tell_lines();
    if (const std::optional<ExitStatus> status = child.poll()) {
      result.status = *status;
      drain(child.out_fd(), result.out, max_output);
      drain(child.err_fd(), result.err, max_output);
      tell_lines();
      if (cancelled) throw *cancelled;
      return result;
    }
    if (kill_at > 0) {
      if (seconds() > kill_at) child.signal_group(SIGKILL);
      continue;
    }
    try {
      progress.check();
    } catch (const Error& error) {
      cancelled = error;
    }
    result.timed_out = timeout_s > 0 && seconds() > timeout_s;
    if (cancelled || result.timed_out) {
      child.signal_group(SIGTERM);
      kill_at = seconds() + 2;
    }
  }
}

std::optional<std::filesystem::path> program_in_path(const std::string& name) {
  const char* path = std::getenv("PATH");
  std::string_view rest = path != nullptr ? path : "/bin:/usr/bin";
  for (;;) {
    const std::size_t end = std::min(rest.find(':'), rest.size());
    const std::filesystem::path found = std::filesystem::path(rest.substr(0, end)) / name;
    std::error_code ignored;
    if (std::filesystem::is_regular_file(found, ignored) && ::access(found.c_str(), X_OK) == 0)
      return found;
    if (end == rest.size()) return std::nullopt;
    rest.remove_prefix(end + 1);
  }
}

std::filesystem::path program_folder() {
  return std::filesystem::read_symlink("/proc/self/exe").parent_path();
}

std::filesystem::path helper_program(const std::string& name) {
  const std::filesystem::path beside = program_folder() / name;
  const std::filesystem::path installed =
      program_folder().parent_path() / "lib" / "packmerger" / name;
  std::error_code ignored;
  const bool only_installed =
      !std::filesystem::exists(beside, ignored) && std::filesystem::exists(installed, ignored);
  return only_installed ? installed : beside;
}

}  // namespace packmerger
