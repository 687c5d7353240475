// Reading and writing a file's bytes block by block, with a sign of life for each (sign_of_life.h).
#pragma once

#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <string_view>
#include <vector>

#include "base/sign_of_life.h"

namespace packmerger {

inline constexpr std::size_t kBlockBytes = 128 << 10;  // a slow share takes a moment for as many

// Calls take(bytes) for each block to the end of the file. False, with errno, where it cannot be
// read. What take() throws ends it.
template <typename Take>
bool read_blocks(int file, const Take& take) {
  std::vector<char> block(kBlockBytes);
  for (;;) {
    const ssize_t count = ::read(file, block.data(), block.size());
    disk_answered();
    if (count == 0) return true;
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return false;
    take(std::string_view(block.data(), static_cast<std::size_t>(count)));
  }
}

// Writes all of it. False, with errno, where it cannot.
inline bool write_bytes(int file, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::write(file, bytes.data(), bytes.size());
    disk_answered();
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
  return true;
}

}  // namespace packmerger
