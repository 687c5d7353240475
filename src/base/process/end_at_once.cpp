#include "base/process/end_at_once.h"

#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <set>
#include <system_error>
#include <thread>

#include "base/process/process.h"
#include "base/remains.h"

namespace packmerger {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::milliseconds kPatience{500};
constexpr std::chrono::milliseconds kPause{10};
constexpr int kAttempts = 30;  // other threads may still be writing there

std::atomic<bool> has_begun{false};

bool are_gone(const std::set<fs::path>& folders) {
  return std::all_of(folders.begin(), folders.end(), [](const fs::path& folder) {
    std::error_code ignored;
    fs::remove_all(folder, ignored);
    return !fs::exists(fs::symlink_status(folder, ignored));
  });
}

}  // namespace

void end_without_remains(int exit_code) {
  has_begun = true;
  Remains& all = remains();
  // Held to the end, so that no process is started any more, and nothing half removed is moved to
  // its place.
  if (all.mutex.try_lock_for(kPatience)) {
    for (const pid_t group : all.groups) signal_group(group, SIGKILL);
    for (int i = 0; i < kAttempts && !are_gone(all.folders); ++i)
      std::this_thread::sleep_for(kPause);
  }
  ::_exit(exit_code);
}

void yield_to_an_end() {
  while (has_begun) ::pause();
}

}  // namespace packmerger
