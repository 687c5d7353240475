#include "cli/late_stop.h"

#include <semaphore.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <string_view>
#include <thread>

#include "base/error.h"
#include "base/process/end_at_once.h"

namespace packmerger::cli {
namespace {

// Most of the program looks for a stop more often.
constexpr std::chrono::milliseconds kPatience{800};

sem_t asked;
std::atomic<bool> watching{false};

void wait_and_end() {
  do {
    while (::sem_wait(&asked) != 0 && errno == EINTR) continue;
    std::this_thread::sleep_for(kPatience);
  } while (!watching);  // it was obeyed, or what it was for is done
  // Past the streams, whose locks others may hold.
  constexpr std::string_view kTold = "\nerror: Interrupted.\n";
  [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, kTold.data(), kTold.size());
  end_without_remains(static_cast<int>(Fault::kInterrupted));
}

}  // namespace

LateStop::LateStop() {
  static const bool begun = [] {
    ::sem_init(&asked, 0, 0);
    std::thread(wait_and_end).detach();
    return true;
  }();
  watching = begun;
}

LateStop::~LateStop() { watching = false; }

void stop_asked() {
  if (watching) ::sem_post(&asked);
}

}  // namespace packmerger::cli
