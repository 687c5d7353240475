// What would be left behind if the program ended in the middle of something.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <mutex>
#include <set>

namespace packmerger {

// Kept by TemporaryFolder and ChildProcess; under the mutex also while a process is started, and
// never while a disk is waited for. A folder is on it from just after it was made until just before
// it is moved to its place.
struct Remains {
  std::timed_mutex mutex;
  std::set<std::filesystem::path> folders;  // temporary ones
  std::set<pid_t> groups;                   // of child processes
};
Remains& remains();

}  // namespace packmerger
