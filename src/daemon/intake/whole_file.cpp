#include "daemon/intake/whole_file.h"

#include <fcntl.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstdint>
#include <fstream>
#include <string>

#include "model/files/file_format.h"

namespace packmerger {
namespace {

constexpr std::uint64_t kStlHeader = 84;  // 80 bytes of text, then the count of triangles
constexpr std::uint64_t kStlTriangle = 50;
constexpr std::uint64_t kZipEnd = 22;  // the end record without its comment
constexpr std::uint64_t kZipEndMost = kZipEnd + 65535;
constexpr std::uint64_t kZip64Mark = 0xFFFFFFFF;

std::uint64_t little_endian(const std::string& bytes, std::size_t at, std::size_t count) {
  std::uint64_t value = 0;
  for (std::size_t i = count; i-- > 0;)
    value = value << 8 | static_cast<unsigned char>(bytes[at + i]);
  return value;
}

std::string bytes_at(std::ifstream& file, std::uint64_t offset, std::uint64_t count) {
  std::string bytes(count, '\0');
  file.clear();
  file.seekg(static_cast<std::streamoff>(offset));
  file.read(bytes.data(), static_cast<std::streamsize>(count));
  bytes.resize(static_cast<std::size_t>(file.gcount()));
  return bytes;
}

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

bool is_whole_stl(std::ifstream& file, std::uint64_t size) {
  const std::string head = bytes_at(file, 0, std::min(size, kStlHeader));
  if (size >= kStlHeader &&
      size == kStlHeader + kStlTriangle * little_endian(head, kStlHeader - 4, 4))
    return true;
  if (lower(head.substr(0, 5)) != "solid") return false;
  const std::uint64_t tail_size = std::min<std::uint64_t>(size, 4096);
  std::string tail = bytes_at(file, size - tail_size, tail_size);
  tail.erase(tail.find_last_not_of(" \t\r\n") + 1);
  const std::size_t line = tail.find_last_of("\r\n");
  std::string last = lower(line == std::string::npos ? tail : tail.substr(line + 1));
  last.erase(0, last.find_first_not_of(" \t"));
  return last.starts_with("endsolid");
}

bool is_whole_zip(std::ifstream& file, std::uint64_t size) {
  const std::uint64_t tail_size = std::min(size, kZipEndMost);
  const std::uint64_t start = size - tail_size;
  const std::string tail = bytes_at(file, start, tail_size);
  for (std::size_t at = tail.rfind("PK\5\6"); at != std::string::npos;
       at = at == 0 ? std::string::npos : tail.rfind("PK\5\6", at - 1)) {
    if (tail.size() - at < kZipEnd) continue;
    if (at + kZipEnd + little_endian(tail, at + 20, 2) != tail.size()) continue;
    const std::uint64_t directory = little_endian(tail, at + 12, 4);
    const std::uint64_t offset = little_endian(tail, at + 16, 4);
    if (offset == kZip64Mark || directory + offset <= start + at) return true;
  }
  return false;
}

}  // namespace

Whole file_is_whole(const std::filesystem::path& path) {
  std::error_code failed;
  const std::uint64_t size = std::filesystem::file_size(path, failed);
  if (failed || size == 0) return Whole::kNo;
  const FileFormat* format = format_of_name(path.filename().string());
  if (format == nullptr || format->end == FileEnd::kNotTold) return Whole::kUnknown;
  std::ifstream file(path, std::ios::binary);
  const bool whole =
      file && (format->end == FileEnd::kStl ? is_whole_stl(file, size) : is_whole_zip(file, size));
  return whole ? Whole::kYes : Whole::kNo;
}

bool is_being_written(const std::filesystem::path& path) {
  const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOFOLLOW);
  if (fd < 0) return false;
  // should somebody open it for writing just now, we are told by a signal that does nothing
  ::fcntl(fd, F_SETSIG, SIGURG);
  // a read lease is granted only on a file that nobody has open for writing
  const bool written = ::fcntl(fd, F_SETLEASE, F_RDLCK) != 0 && errno == EAGAIN;
  ::close(fd);
  return written;
}

}  // namespace packmerger
