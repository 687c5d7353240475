// Whether a file that somebody may still be writing is whole, as far as its format tells.
#pragma once

#include <filesystem>

namespace packmerger {

enum class Whole {
  kYes,      // the format's own end is there
  kNo,       // empty, or the format's end is missing
  kUnknown,  // a format that does not tell
};

// By the end that its format has (FileEnd of model/files/file_format.h). Reads at most 66 kB. A
// file that cannot be read is kNo.
Whole file_is_whole(const std::filesystem::path& path);

// Whether another process has the file open for writing, as far as the kernel tells (it does for
// files on local file systems that belong to the daemon's user, or when it runs as root).
bool is_being_written(const std::filesystem::path& path);

}  // namespace packmerger
