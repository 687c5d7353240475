// One daemon for each state folder.
#pragma once

#include <filesystem>

namespace packmerger {

// Held while the process lives; the kernel lets go of it however the process ends.
class StateLock {
 public:
  // Throws Error{kBusy} where another process holds it, Error{kCannotWrite} where it cannot be
  // made.
  explicit StateLock(const std::filesystem::path& state);
  StateLock(const StateLock&) = delete;
  StateLock& operator=(const StateLock&) = delete;
  ~StateLock();

 private:
  int fd_ = -1;
};

}  // namespace packmerger
