#include "base/files.h"

#include <fcntl.h>
#include <openssl/evp.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "base/blocks.h"
#include "base/descriptor.h"
#include "base/error.h"
#include "base/remains.h"
#include "base/sign_of_life.h"

namespace packmerger {
namespace {

std::string reason() { return std::strerror(errno); }

[[noreturn]] void cannot_write(const fs::path& path, const std::string& why) {
  throw Error(Fault::kCannotWrite, "Cannot write " + path.string() + ": " + why,
              "Check that the folder exists, may be written to and has free space.");
}

void sync_path(const fs::path& path, int flags) {
  Descriptor file(::open(path.c_str(), flags | O_CLOEXEC));
  if (file.get() < 0 || ::fsync(file.get()) != 0) cannot_write(path, reason());
  disk_answered();
}

// Calls take(bytes) for each block of the file.
template <typename Take>
void read_blocks_of(const fs::path& path, const Take& take) {
  Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (file.get() < 0) {
    const bool missing = errno == ENOENT || errno == ENOTDIR;
    throw Error(missing ? Fault::kNoInput : Fault::kIo,
                "Cannot open " + path.string() + ": " + reason(),
                "Check the name and that you may read it.");
  }
  if (!read_blocks(file.get(), take))
    throw Error(Fault::kIo, "Cannot read " + path.string() + ": " + reason(),
                "Check the disk or the network share it is on.");
}

class Sha256 {
 public:
  Sha256() : context_(EVP_MD_CTX_new(), EVP_MD_CTX_free) {
    EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr);
  }
  void add(std::string_view bytes) { EVP_DigestUpdate(context_.get(), bytes.data(), bytes.size()); }
  std::string hex() {
    std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
    unsigned length = 0;
    EVP_DigestFinal_ex(context_.get(), digest.data(), &length);
    static constexpr char kDigits[] = "0123456789abcdef";
    std::string text;
    for (unsigned i = 0; i < length; ++i) {
      text += kDigits[digest[i] >> 4];
      text += kDigits[digest[i] & 15];
    }
    return text;
  }

 private:
  std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context_;
};

fs::path make_private_folder(const fs::path& pattern) {
  std::string name = pattern.string();
  if (::mkdtemp(name.data()) == nullptr) cannot_write(pattern, reason());
  return name;
}

// ".NAME.XXXXXX" beside path, with letters that nobody has taken: make(name) says 0, or -1 with
// errno. With the mode that it is to keep: who is confined may not change one.
template <typename Make>
std::string make_beside(const fs::path& path, const Make& make) {
  static constexpr std::string_view kLetters = "0123456789abcdefghijklmnopqrstuv";
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  const std::string start = (folder / ("." + path.filename().string() + ".")).string();
  for (;;) {
    std::array<unsigned char, 6> random{};
    if (::getrandom(random.data(), random.size(), 0) < 0) cannot_write(path, reason());
    std::string name = start;
    for (const unsigned char each : random) name += kLetters[each % kLetters.size()];
    const bool is_made = make(name.c_str()) >= 0;
    disk_answered();
    if (is_made) return name;
    if (errno != EEXIST) cannot_write(path, reason());
  }
}

}  // namespace

std::string read_file(const fs::path& path, std::uint64_t max_bytes) {
  std::error_code ignored;
  const fs::file_status kind = fs::status(path, ignored);
  if (fs::exists(kind) && !fs::is_regular_file(kind))
    throw Error(
        Fault::kNoInput,
        path.string() + (fs::is_directory(kind) ? " is a folder" : " is not a regular file"),
        "Name a file instead.");
  const std::uint64_t size = fs::file_size(path, ignored);
  const auto refuse = [&] {
    throw Error(Fault::kBadInput,
                path.string() + " is larger than " + std::to_string(max_bytes >> 20) + " MiB",
                "Reduce the model, for example by decimating it, and try again.");
  };
  if (!ignored && size > max_bytes) refuse();
  std::string bytes;
  if (!ignored) bytes.reserve(size);
  read_blocks_of(path, [&](std::string_view block) {
    if (bytes.size() + block.size() > max_bytes) refuse();
    bytes.append(block);
  });
  return bytes;
}

void write_file_whole(const fs::path& path, std::string_view bytes, unsigned mode) {
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  int made = -1;
  const std::string name = make_beside(path, [&](const char* free) {
    return made = ::open(free, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode);
  });
  Descriptor file(made);
  const auto fail = [&] {
    const std::string why = reason();
    ::unlink(name.c_str());
    cannot_write(path, why);
  };
  if (!write_bytes(file.get(), bytes)) fail();
  if (::fsync(file.get()) != 0) fail();
  disk_answered();
  if (::close(file.release()) != 0) fail();
  disk_answered();
  if (::rename(name.c_str(), path.c_str()) != 0) fail();
  disk_answered();
  sync_folder(folder);
}

int rename_keeping(const fs::path& from, const fs::path& to) {
  const auto worked = [](int result) {
    disk_answered();
    return result == 0;
  };
  if (worked(::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE))) return 0;
  if (errno != EINVAL && errno != ENOSYS) return errno;
  if (worked(::link(from.c_str(), to.c_str()))) return worked(::unlink(from.c_str())) ? 0 : errno;
  if (errno == EEXIST || errno == EXDEV || errno == ENOENT) return errno;
  struct stat there {};
  if (worked(::lstat(to.c_str(), &there))) return EEXIST;
  return worked(::rename(from.c_str(), to.c_str())) ? 0 : errno;
}

void sync_folder(const fs::path& folder) { sync_path(folder, O_RDONLY | O_DIRECTORY); }

void sync_tree(const fs::path& folder) {
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) sync_path(entry.path(), O_RDONLY);
    if (entry.is_directory()) sync_folder(entry.path());
  }
  sync_folder(folder);
}

std::string sha256_hex(std::string_view bytes) {
  Sha256 hash;
  hash.add(bytes);
  return hash.hex();
}

std::string sha256_hex_of_file(const fs::path& path) {
  Sha256 hash;
  read_blocks_of(path, [&](std::string_view block) { hash.add(block); });
  return hash.hex();
}

TemporaryFolder::TemporaryFolder()
    : TemporaryFolder(make_private_folder(fs::temp_directory_path() / "packmerger.XXXXXX")) {}

TemporaryFolder::TemporaryFolder(fs::path path) : path_(std::move(path)) {
  const std::lock_guard lock(remains().mutex);
  remains().folders.insert(path_);
}

TemporaryFolder TemporaryFolder::beside(const fs::path& target) {
  const fs::path whole = fs::absolute(target).lexically_normal();
  const fs::path clean = whole.has_filename() ? whole : whole.parent_path();
  return TemporaryFolder(make_beside(clean, [](const char* free) { return ::mkdir(free, 0755); }));
}

TemporaryFolder::~TemporaryFolder() {
  if (path_.empty()) return;
  std::error_code ignored;
  fs::remove_all(path_, ignored);
  const std::lock_guard lock(remains().mutex);
  remains().folders.erase(path_);
}

void TemporaryFolder::publish(const fs::path& target) {
  const fs::path whole = fs::absolute(target).lexically_normal();
  const fs::path clean = whole.has_filename() ? whole : whole.parent_path();
  sync_tree(path_);
  // What is whole is nothing to be removed. Under the lock nothing waits for a disk, which may
  // hang.
  {
    const std::lock_guard lock(remains().mutex);
    remains().folders.erase(path_);
  }
  const int why = rename_keeping(path_, clean);
  if (why != 0) {
    const std::lock_guard lock(remains().mutex);
    remains().folders.insert(path_);
    cannot_write(clean, std::strerror(why));
  }
  path_.clear();
  sync_folder(clean.parent_path());
}

}  // namespace packmerger
