#include "delivery/progress_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

#include "base/error.h"

namespace packmerger {

namespace {

// Every record has the same length, so that a new one covers the old one whole.
std::string record_of(const Told& told) {
  return fmt::format("acknowledged {:012} of {:012}\n", told.done, told.total);
}

// So long too: on a disk that takes this, the first record finds its place.
constexpr std::string_view kNothing = "nothing of the program was sent so far   \n";

constexpr std::uint64_t kMostBytes = 4096;

}  // namespace

// What is there stays until the first record covers it: how far another print of the tray came.
ProgressFile::ProgressFile(fs::path path)
    : path_(std::move(path)), fd_(::open(path_.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0644)) {
  if (fd_.get() < 0) fail();
  std::error_code failed;
  if (fs::file_size(path_, failed) == 0 && !failed) write(kNothing);
}

void ProgressFile::write(std::string_view text) const {
  if (::pwrite(fd_.get(), text.data(), text.size(), 0) != static_cast<ssize_t>(text.size())) fail();
}

void ProgressFile::acknowledged(std::size_t done, std::size_t total) {
  if (is_first_ || done != written_.done || total != written_.total) {
    written_ = {done, total};
    write(record_of(written_));
    synced_ = false;
  }
  const auto now = std::chrono::steady_clock::now();
  if (synced_ || (!is_first_ && now - synced_at_ < std::chrono::seconds(1))) return;
  if (::fdatasync(fd_.get()) != 0) fail();
  if (is_first_) sync_folder(path_.parent_path());
  is_first_ = false;
  synced_ = true;
  synced_at_ = now;
}

void ProgressFile::fail() const {
  throw Error(
      Fault::kCannotWrite,
      "Cannot write how far the print is to " + path_.string() + ": " + std::strerror(errno),
      "Make the folder writable and see that its disk is not full.");
}

bool has_sent_nothing(const fs::path& path) {
  std::error_code failed;
  if (!fs::exists(path, failed)) return !failed;
  try {
    const std::string text = read_file(path, kMostBytes);
    return text.empty() || text.starts_with(kNothing);
  } catch (const Error&) {
    return false;
  }
}

std::optional<Told> read_told(const fs::path& path) {
  std::error_code ignored;
  if (!fs::is_regular_file(path, ignored)) return std::nullopt;
  Told told;
  try {
    const std::string text = read_file(path, kMostBytes);
    const bool is_record =
        std::sscanf(text.c_str(), "acknowledged %12zu of %12zu", &told.done, &told.total) == 2;
    return is_record && told.done <= told.total ? std::optional(told) : std::nullopt;
  } catch (const Error&) {
    return std::nullopt;
  }
}

std::string told_text(const Told& told, std::string_view unit) {
  const double percent =
      told.total == 0 ? 0
                      : 100.0 * static_cast<double>(told.done) / static_cast<double>(told.total);
  return fmt::format("{} {} of {} ({:.0f} %)", unit, told.done, told.total, percent);
}

}  // namespace packmerger
