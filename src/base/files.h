// Files: bounded reading, writing that is whole or absent, temporary folders, and SHA-256.
// Every failure is an Error with Fault kNoInput, kIo, kBadInput (too large) or kCannotWrite.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>

namespace packmerger {

namespace fs = std::filesystem;

// Reads a whole regular file; pipes, devices and folders are refused, since they may never end. A
// file larger than max_bytes is refused before it is read.
std::string read_file(const fs::path& path, std::uint64_t max_bytes);

// Writes bytes to path through a temporary sibling: write, fsync, rename, fsync of the folder.
// Afterwards path holds all the bytes, or what it held before. The umask takes from the mode.
void write_file_whole(const fs::path& path, std::string_view bytes, unsigned mode = 0644);

// Renames a file or folder to `to`, which must not exist. Returns 0 or an errno (EEXIST, EXDEV, …).
// Some network file systems know no renameat2 flags; there a hard link, or where even those are
// missing a look before the rename, keeps what exists.
int rename_keeping(const fs::path& from, const fs::path& to);

// fsyncs every file below folder and the folders themselves.
void sync_tree(const fs::path& folder);

// fsyncs one folder, so that a rename in it survives a power cut.
void sync_folder(const fs::path& folder);

// 64 lower-case hex digits.
std::string sha256_hex(std::string_view bytes);
std::string sha256_hex_of_file(const fs::path& path);

// A new folder, removed with its contents when the object dies unless it was kept or moved away.
class TemporaryFolder {
 public:
  // Below the system's temporary folder, mode 0700.
  TemporaryFolder();
  // Beside `target` (same file system, so that it can be renamed to it): ".NAME.XXXXXX", mode 0755
  // less the umask.
  static TemporaryFolder beside(const fs::path& target);

  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  TemporaryFolder(TemporaryFolder&& other) noexcept : path_(std::exchange(other.path_, {})) {}
  TemporaryFolder& operator=(TemporaryFolder&&) = delete;
  ~TemporaryFolder();

  const fs::path& path() const { return path_; }

  // Syncs the contents and renames the folder to target, which must not exist. Error{kCannotWrite}.
  void publish(const fs::path& target);

 private:
  explicit TemporaryFolder(fs::path path);
  fs::path path_;
};

}  // namespace packmerger
