#include "base/move_file.h"

#include <fcntl.h>
#include <stdio.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <vector>

#include "base/descriptor.h"
#include "base/error.h"
#include "base/names.h"
#include "base/sign_of_life.h"
#include "base/time/clock.h"

namespace packmerger {
namespace {

constexpr std::size_t kBlock = 128 << 10;  // bytes; a slow share takes a moment for as many
constexpr std::size_t kMaxName = 255;      // bytes of a file's name on Linux
constexpr std::array<std::string_view, 4> kBeside = {".reason.txt", ".result.json", ".preview.png",
                                                     ".toml"};

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

// 0 at the end.
std::size_t read_block(const fs::path& from, int in, std::vector<char>& block) {
  for (;;) {
    const ssize_t count = ::read(in, block.data(), block.size());
    disk_answered();
    if (count >= 0) return static_cast<std::size_t>(count);
    if (errno == EINTR) continue;
    throw Error(Fault::kIo, "Cannot read " + printable(from.string()) + ": " + std::strerror(errno),
                "Check the disk or the network share it is on.");
  }
}

void write_block(const fs::path& from, const fs::path& to, int out, const char* bytes,
                 std::size_t count) {
  while (count > 0) {
    const ssize_t written = ::write(out, bytes, count);
    disk_answered();
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) cannot_move(from, to, errno);
    bytes += written;
    count -= static_cast<std::size_t>(written);
  }
}

void copy_bytes(const fs::path& from, int in, const fs::path& to, int out) {
  std::vector<char> block(kBlock);
  Pace pace;
  std::size_t unsynced = 0;
  double begun_s = steady_now_s();
  while (const std::size_t count = read_block(from, in, block)) {
    write_block(from, to, out, block.data(), count);
    unsynced += count;
    if (unsynced < pace.bytes()) continue;
    if (::fdatasync(out) != 0) cannot_move(from, to, errno);
    disk_answered();
    pace.took(steady_now_s() - begun_s);
    unsynced = 0;
    begun_s = steady_now_s();
  }
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

fs::path free_path(const fs::path& folder, const std::string& name) {
  const fs::path plain(name);
  const std::string extension = first_bytes(plain.extension().string(), 32);
  for (int number = 1;; ++number) {
    const std::string tail =
        (number == 1 ? std::string() : " (" + std::to_string(number) + ")") + extension;
    const fs::path path =
        folder / (first_bytes(plain.stem().string(), kMaxName - tail.size()) + tail);
    const bool taken =
        is_taken(path) || std::any_of(kBeside.begin(), kBeside.end(), [&](std::string_view suffix) {
          return is_taken(note_beside(path, suffix));
        });
    if (!taken) return path;
  }
}

fs::path note_beside(const fs::path& file, std::string_view suffix) {
  return file.parent_path() /
         (first_bytes(file.filename().string(), kMaxName - suffix.size()) + std::string(suffix));
}

}  // namespace packmerger
