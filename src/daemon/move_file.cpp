#include "daemon/move_file.h"

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

namespace packmerger {
namespace {

constexpr std::size_t kMaxName = 255;  // bytes of a file's name on Linux
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

void copy_bytes(const fs::path& from, int in, const fs::path& to, int out,
                const std::function<void()>& on_block) {
  std::vector<char> block(1 << 20);
  for (;;) {
    const ssize_t count = ::read(in, block.data(), block.size());
    if (count == 0) return;
    if (count < 0 && errno == EINTR) continue;
    if (count < 0)
      throw Error(Fault::kIo,
                  "Cannot read " + printable(from.string()) + ": " + std::strerror(errno),
                  "Check the disk or the network share it is on.");
    for (ssize_t done = 0; done < count;) {
      const ssize_t written =
          ::write(out, block.data() + done, static_cast<std::size_t>(count - done));
      if (written < 0 && errno == EINTR) continue;
      if (written < 0) cannot_move(from, to, errno);
      done += written;
      if (on_block) on_block();
    }
  }
}

}  // namespace

bool is_taken(const fs::path& path) {
  struct stat status {};
  return ::lstat(path.c_str(), &status) == 0;
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

void copy_file_whole(const fs::path& from, const fs::path& to,
                     const std::function<void()>& on_block) {
  make_folders(to.parent_path());
  const Descriptor in(::open(from.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK));
  if (in.get() < 0) cannot_move(from, to, errno);
  std::string name = (to.parent_path() / ".copy.XXXXXX").string();
  const Descriptor out(::mkostemp(name.data(), O_CLOEXEC));
  if (out.get() < 0) cannot_move(from, to, errno);
  try {
    copy_bytes(from, in.get(), to, out.get(), on_block);
    if (::fchmod(out.get(), 0644) != 0 || ::fsync(out.get()) != 0) cannot_move(from, to, errno);
    const int why = rename_keeping(name, to);
    if (why != 0) cannot_move(from, to, why);
  } catch (...) {
    ::unlink(name.c_str());
    throw;
  }
  sync_folder(to.parent_path());
}

void move_new(const fs::path& from, const fs::path& to, const std::function<void()>& on_block) {
  if (rename_new(from, to) == Moved::kYes) return;
  copy_file_whole(from, to, on_block);
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
