// Files for a fuzzer that runs a million times in one folder.
#pragma once

#include <fstream>
#include <ios>
#include <string_view>

#include "base/files.h"

namespace packmerger::fuzz {

// Gone at the program's end.
inline const fs::path& folder() {
  static const TemporaryFolder folder;
  return folder.path();
}

// Without the care for a power cut that the daemon takes.
inline void put(const fs::path& file, std::string_view text) {
  std::ofstream(file, std::ios::binary)
      .write(text.data(), static_cast<std::streamsize>(text.size()));
}

}  // namespace packmerger::fuzz
