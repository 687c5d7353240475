#include "daemon/state_lock.h"

#include <fcntl.h>
#include <unistd.h>

#include "base/error.h"

namespace packmerger {

// A record lock: unlike flock's it is not kept by a child that was being started when the daemon
// was killed.
StateLock::StateLock(const std::filesystem::path& state) {
  const std::filesystem::path file = state / "lock";
  fd_ = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  if (fd_ < 0)
    throw Error(Fault::kCannotWrite, "Cannot write " + file.string(),
                "Give the daemon's user the right to write to its state folder.");
  struct flock whole {};
  whole.l_type = F_WRLCK;
  whole.l_whence = SEEK_SET;
  if (::fcntl(fd_, F_SETLK, &whole) == 0) return;
  ::close(fd_);
  throw Error(Fault::kBusy, "Another packmergerd works in " + state.string(),
              "End it first, or give this one another state folder.");
}

StateLock::~StateLock() { ::close(fd_); }

}  // namespace packmerger
