// Child processes, each the leader of a process group of its own, so that it and its
// grandchildren can be ended together. POSIX fork and exec; no shell ever reads a command.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/progress.h"

namespace packmerger {

struct ProcessSpec {
  std::vector<std::string> argv;               // argv[0] is looked up in PATH unless it has a slash
  std::map<std::string, std::string> set_env;  // added to or replacing the parent's
  std::vector<std::string> unset_env;
  std::filesystem::path folder;        // working folder; empty: the parent's
  std::uint64_t max_memory_bytes = 0;  // RLIMIT_AS; 0: no limit
  int nice = 0;                        // added to the parent's
  // Not empty: the child is confined (base/process/confinement.h) and may write below these folders
  // only.
  std::vector<std::filesystem::path> only_writable;
};

struct ExitStatus {
  int code = 0;    // exit code, when signal == 0
  int signal = 0;  // the signal that ended it, or 0
  bool ok() const { return code == 0 && signal == 0; }
  // As shells and the loader of shared libraries tell it: nothing of the program ran.
  bool could_not_start() const { return signal == 0 && (code == 126 || code == 127); }
};

// Sends signal to a process group of the caller's session, which a confined caller may do too.
void signal_group(pid_t group, int signal);

// A running child. Its standard input is /dev/null; standard output and error are pipes whose
// reading ends are non-blocking. The destructor kills the whole group and reaps the child. The
// child also gets SIGTERM when the thread that started it dies.
class ChildProcess {
 public:
  // Throws Error{kUnavailable} when the program is not there, Error{kInternal} when no process can
  // be made or confined.
  explicit ChildProcess(const ProcessSpec& spec);
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;
  ~ChildProcess();

  pid_t pid() const { return pid_; }
  int out_fd() const { return out_; }
  int err_fd() const { return err_; }

  // The status once the child has ended; reaps it.
  std::optional<ExitStatus> poll();
  void signal_group(int signal) const { packmerger::signal_group(pid_, signal); }

 private:
  pid_t pid_ = -1;
  int out_ = -1;
  int err_ = -1;
  std::optional<ExitStatus> status_;
};

struct ProcessResult {
  ExitStatus status;
  bool timed_out = false;
  std::string out;  // at most max_output bytes of each; the rest is read and dropped
  std::string err;
};

// Runs a child to its end. Cancelling through progress, or timeout_s (0: none) passing, ends the
// group with SIGTERM and, two seconds later, SIGKILL. on_err_line, where given, sees each whole
// line of standard error as it comes.
ProcessResult run_process(const ProcessSpec& spec, double timeout_s, const Progress& progress,
                          const std::function<void(std::string_view)>& on_err_line = {},
                          std::size_t max_output = std::size_t{16} << 20);

// The program that a child of this name would run: the first of $PATH that may be executed.
std::optional<std::filesystem::path> program_in_path(const std::string& name);

// The folder the running program lies in.
std::filesystem::path program_folder();

// A helper of ours that no person runs: beside the running program, or in ../lib/packmerger where
// it is installed. Beside the program where it is in neither.
std::filesystem::path helper_program(const std::string& name);

}  // namespace packmerger
