#include "daemon/room_to_start.h"

#include <fcntl.h>
#include <stdlib.h>
#include <unistd.h>

#include <cerrno>

#include "base/descriptor.h"
#include "base/names.h"
#include "base/time/wall_clock.h"
#include "daemon/intake/folder_actions.h"
#include "job/store/deletable_jobs.h"

namespace packmerger {
namespace {

namespace fs = std::filesystem;

constexpr off_t kWanted = 4 << 20;  // bytes: the database's log and index, and what recovering adds

bool is_full(int why) { return why == ENOSPC || why == EDQUOT; }

void add(Deleted& sum, Deleted part) {
  sum.jobs.insert(sum.jobs.end(), part.jobs.begin(), part.jobs.end());
  sum.left.insert(sum.left.end(), part.left.begin(), part.left.end());
  if (!sum.failure) sum.failure = std::move(part.failure);
}

}  // namespace

// It is tried, since what the system says is free may be others' alone.
bool has_room_to_start(const fs::path& state) {
  std::string name = (state / ".room.XXXXXX").string();
  const Descriptor file(::mkostemp(name.data(), O_CLOEXEC));
  if (file.get() < 0) return !is_full(errno);
  ::unlink(name.c_str());
  return !is_full(::posix_fallocate(file.get(), 0, kWanted));
}

Deleted make_room_to_start(const fs::path& state,
                           const std::function<void(const std::string&)>& log,
                           const std::function<bool()>& has_room) {
  Deleted deleted;
  if (has_room()) return deleted;
  log("the disk with " + printable(state.string()) +
      " is full: the folders of the oldest jobs are deleted");
  try {
    for (const auto& jobs :
         read_deletable(state / "jobs.sqlite", unix_now_s() - kSparedAfterEnd_s)) {
      DeleteOrder order{jobs, {}};
      for (const std::int64_t id : jobs)
        order.folders.push_back(state / "jobs" / std::to_string(id));
      add(deleted, clear_away(order));
      if (has_room()) break;
    }
  } catch (const std::exception& error) {
    log(std::string("which of them may be deleted is not known: ") + error.what());
  }
  return deleted;
}

Deleted make_room_to_start(const fs::path& state,
                           const std::function<void(const std::string&)>& log) {
  return make_room_to_start(state, log, [&] { return has_room_to_start(state); });
}

}  // namespace packmerger
