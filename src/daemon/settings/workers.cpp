#include "daemon/settings/workers.h"

#include <unistd.h>

#include <algorithm>
#include <thread>

namespace packmerger {
namespace {

// 0 where the system does not tell.
std::uint64_t memory_of_this_machine() {
  const long pages = ::sysconf(_SC_PHYS_PAGES);
  const long page = ::sysconf(_SC_PAGESIZE);
  return pages > 0 && page > 0
             ? static_cast<std::uint64_t>(pages) * static_cast<std::uint64_t>(page)
             : 0;
}

}  // namespace

int workers_for(unsigned cores, std::uint64_t memory, std::uint64_t memory_bytes) {
  const std::uint64_t fewest = std::min<std::uint64_t>(cores / 2, memory / memory_bytes);
  return static_cast<int>(std::clamp<std::uint64_t>(fewest, 1, kMostWorkers));
}

int workers_of(const PrepareConfig& prepare) {
  // asked once: this is called of each job that waits, at every turn of the loop
  static const unsigned cores = std::thread::hardware_concurrency();
  static const std::uint64_t memory = memory_of_this_machine();
  return prepare.workers.value_or(workers_for(cores, memory, prepare.memory_bytes));
}

}  // namespace packmerger
