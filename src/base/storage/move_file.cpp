#include "base/storage/move_file.h"

#include <fcntl.h>
#include <stdio.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "base/blocks.h"
#include "base/descriptor.h"
#include "base/error.h"
#include "base/names.h"
#include "base/sign_of_life.h"
#include "base/time/clock.h"

namespace packmerger {
namespace {

[[noreturn]] void cannot_move(const fs::path& from, const fs::path& to, int why) {
  const std::string what = printable(from.string()) + " cannot be moved to " +
                           printable(to.string()) + ": " + std::strerror(why);
  if (why == EEXIST) throw Error(Fault::kBusy, what, "Rename one of the two files.");
  if (why == ENOENT) throw Error(Fault::kNoInput, what, "Drop the file again.");
  throw Error(Fault::kCannotWrite, what,
              "Give the daemon's user the right to write to both folders, and free space.");
}

void make_folders(const fs::path& folder) {
  std::error_code failed;
  fs::create_directories(folder, failed);
  if (failed)
    throw Error(Fault::kCannotWrite,
                "Cannot make " + printable(folder.string()) + ": " + failed.message(),
                "Give the daemon's user the right to write there.");
}

// How much is written before the disk is asked to have it all: on a slow one so little that each
// answer comes within seconds, and the end of a long copy is no single wait of minutes. Not less
// than that, since many a share takes seconds for each sync whatever is to be synced.
class Pace {
 public:
  std::size_t bytes() const { return bytes_; }

  void took(double seconds) {
    if (seconds < kQuick_s) bytes_ = std::min(2 * bytes_, kMost);
    if (seconds > kSlow_s) bytes_ = std::max(bytes_ / 2, kLeast);
  }

 private:
  static constexpr double kQuick_s = 2;
  static constexpr double kSlow_s = 7;
  static constexpr std::size_t kLeast = std::size_t{128} << 10;
  static constexpr std::size_t kMost = std::size_t{8} << 20;

  std::size_t bytes_ = std::size_t{2} << 20;
};

void copy_bytes(const fs::path& from, int in, const fs::path& to, int out) {
  Pace pace;
  std::size_t unsynced = 0;
  double begun_s = steady_now_s();
  const bool is_read = read_blocks(in, [&](std::string_view block) {
    if (!write_bytes(out, block)) cannot_move(from, to, errno);
    unsynced += block.size();
    if (unsynced < pace.bytes()) return;
    if (::fdatasync(out) != 0) cannot_move(from, to, errno);
    disk_answered();
    pace.took(steady_now_s() - begun_s);
    unsynced = 0;
    begun_s = steady_now_s();
  });
  if (!is_read)
    throw Error(Fault::kIo, "Cannot read " + printable(from.string()) + ": " + std::strerror(errno),
                "Check the disk or the network share it is on.");
  if (::fsync(out) != 0) cannot_move(from, to, errno);
  disk_answered();
}

}  // namespace

bool is_taken(const fs::path& path) {
  struct stat status {};
  const bool is_there = ::lstat(path.c_str(), &status) == 0;
  disk_answered();
  return is_there;
}

Moved rename_new(const fs::path& from, const fs::path& to) {
  make_folders(to.parent_path());
  const int why = rename_keeping(from, to);
  if (why == EXDEV) return Moved::kOtherFileSystem;
  if (why != 0) cannot_move(from, to, why);
  sync_folder(to.parent_path());
  sync_folder(from.parent_path());
  return Moved::kYes;
}

void copy_file_whole(const fs::path& from, const fs::path& to) {
  make_folders(to.parent_path());
  const Descriptor in(::open(from.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK));
  if (in.get() < 0) cannot_move(from, to, errno);
  std::string name = (to.parent_path() / ".copy.XXXXXX").string();
  const Descriptor out(::mkostemp(name.data(), O_CLOEXEC));
  if (out.get() < 0) cannot_move(from, to, errno);
  try {
    if (::fchmod(out.get(), 0644) != 0) cannot_move(from, to, errno);
    copy_bytes(from, in.get(), to, out.get());
    const int why = rename_keeping(name, to);
    if (why != 0) cannot_move(from, to, why);
  } catch (...) {
    ::unlink(name.c_str());
    throw;
  }
  sync_folder(to.parent_path());
}

void move_new(const fs::path& from, const fs::path& to) {
  if (rename_new(from, to) == Moved::kYes) return;
  copy_file_whole(from, to);
  if (::unlink(from.c_str()) != 0) cannot_move(from, to, errno);
}

}  // namespace packmerger
