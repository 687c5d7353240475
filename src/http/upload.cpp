#include "http/upload.h"

#include <fcntl.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>

namespace packmerger {
namespace {

constexpr int kTooLarge = 413;
constexpr int kNoRoom = 507;
constexpr int kCannotWrite = 500;
constexpr std::uint64_t kLookEvery = std::uint64_t{16} << 20;  // bytes, at the free space

int status_of(int error) { return error == ENOSPC || error == EDQUOT ? kNoRoom : kCannotWrite; }

}  // namespace

Upload::~Upload() {
  for (const UploadedFile& file : files_) ::unlink(file.path.c_str());
}

bool Upload::has_room(const std::filesystem::path& folder, std::uint64_t bytes,
                      std::uint64_t spare_bytes) {
  struct statvfs disk;
  if (::statvfs(folder.c_str(), &disk) != 0) return true;
  const std::uint64_t free = std::uint64_t{disk.f_bavail} * disk.f_frsize;
  return free >= spare_bytes && free - spare_bytes >= bytes;
}

int Upload::begin(std::string_view field, std::string_view name) {
  if (const int status = end(); status != 0) return status;
  std::string path = (folder_ / "upload-XXXXXX").string();
  const int fd = ::mkostemp(path.data(), O_CLOEXEC);
  if (fd < 0) return status_of(errno);
  file_.emplace(fd);
  files_.push_back({std::string(field), std::string(name), path, 0});
  return 0;
}

int Upload::write(std::string_view bytes) {
  if (!file_) return kCannotWrite;
  written_ += bytes.size();
  if (written_ > most_bytes_) return kTooLarge;
  if (written_ - looked_at_ > kLookEvery) {
    looked_at_ = written_;
    if (!has_room(folder_, 0, spare_bytes_)) return kNoRoom;
  }
  files_.back().bytes += bytes.size();
  while (!bytes.empty()) {
    const ssize_t count = ::write(file_->get(), bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return status_of(errno);
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
  return 0;
}

int Upload::end() {
  if (!file_) return 0;
  const bool is_safe = ::fsync(file_->get()) == 0;
  const int error = errno;
  file_.reset();
  return is_safe ? 0 : status_of(error);
}

}  // namespace packmerger
