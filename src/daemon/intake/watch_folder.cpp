#include "daemon/intake/watch_folder.h"

#include <sys/inotify.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <set>
#include <tuple>

#include "base/error.h"
#include "base/names.h"
#include "base/sign_of_life.h"
#include "base/time/backoff.h"
#include "daemon/intake/beside.h"
#include "daemon/intake/whole_file.h"

namespace packmerger {
namespace {

constexpr double kPendingLook_s = 0.25;  // while a file waits to become whole

// IN_CREATE: a hard link is complete without ever being closed or moved.
constexpr std::uint32_t kEvents = IN_CLOSE_WRITE | IN_MOVED_TO | IN_CREATE | IN_ONLYDIR;

[[noreturn]] void cannot_read(const fs::path& folder, int why) {
  throw Error(Fault::kIo, "Cannot watch " + printable(folder.string()) + ": " + std::strerror(why),
              "Give the daemon's user the right to read it; it is tried again.");
}

std::uint64_t inode_of(const fs::path& folder) {
  struct stat status {};
  return ::stat(folder.c_str(), &status) == 0 ? status.st_ino : 0;
}

std::string reason_to_ignore(const struct stat& status) {
  if (S_ISLNK(status.st_mode))
    return "it is a symbolic link; the daemon takes only files themselves. Copy the file here.";
  if (S_ISDIR(status.st_mode))
    return "it is a folder; the daemon takes only files. Put the files themselves here.";
  if (!S_ISREG(status.st_mode)) return "it is no regular file.";
  return {};
}

std::int64_t modified_ns(const struct stat& status) {
  return std::int64_t{status.st_mtim.tv_sec} * 1000000000 + status.st_mtim.tv_nsec;
}

}  // namespace

bool is_temporary_name(std::string_view name) {
  if (name.empty() || name.front() == '.' || name.front() == '~') return true;
  static constexpr std::array<std::string_view, 4> kEndings = {".part", ".tmp", ".crdownload",
                                                               ".filepart"};
  return std::any_of(kEndings.begin(), kEndings.end(),
                     [&](std::string_view ending) { return name.ends_with(ending); });
}

WatchFolder::WatchFolder(fs::path folder, const WatchConfig& rules)
    : folder_(std::move(folder)),
      rules_(rules),
      inotify_(::inotify_init1(IN_NONBLOCK | IN_CLOEXEC)) {
  if (inotify_ < 0) cannot_read(folder_, errno);
  try {
    set_watch();
  } catch (...) {
    ::close(inotify_);
    throw;
  }
}

WatchFolder::~WatchFolder() { ::close(inotify_); }

// The folder may have been removed and made again: then the watch is on the wrong one.
void WatchFolder::set_watch() {
  std::error_code failed;
  fs::create_directories(folder_, failed);
  if (failed)
    throw Error(Fault::kCannotWrite,
                "Cannot make " + printable(folder_.string()) + ": " + failed.message(),
                "Give the daemon's user the right to write there, or name another folder.");
  if (watch_ >= 0 && inode_of(folder_) == watched_inode_) return;
  if (watch_ >= 0) ::inotify_rm_watch(inotify_, watch_);
  watch_ = ::inotify_add_watch(inotify_, folder_.c_str(), kEvents);
  if (watch_ < 0) cannot_read(folder_, errno);
  watched_inode_ = inode_of(folder_);
}

// True when the folder has to be read.
bool WatchFolder::read_events() {
  alignas(inotify_event) std::array<char, 16384> block;
  bool happened = false;
  for (;;) {
    const ssize_t count = ::read(inotify_, block.data(), block.size());
    if (count <= 0) return happened;
    happened = true;
    for (ssize_t at = 0; at < count;) {
      inotify_event event;
      std::memcpy(&event, block.data() + at, sizeof event);
      const char* name = block.data() + at + sizeof event;
      if (event.wd == watch_ && (event.mask & IN_IGNORED) != 0) watch_ = -1;  // the folder is gone
      if (event.len > 0 && (event.mask & (IN_CLOSE_WRITE | IN_MOVED_TO)) != 0 &&
          !is_temporary_name(name))
        seen_[name].closed = true;
      at += static_cast<ssize_t>(sizeof event + event.len);
    }
  }
}

WatchFolder::Found WatchFolder::look(double now_s) {
  Found found;
  const bool happened = read_events();
  if (!happened && now_s < next_look_s_) return found;
  next_look_s_ = now_s + rules_.rescan_s;  // also where an error is thrown below
  set_watch();
  read_folder(now_s, found);
  return found;
}

void WatchFolder::read_folder(double now_s, Found& found) {
  std::error_code failed;
  fs::directory_iterator entries(folder_, failed);
  if (failed) cannot_read(folder_, failed.value());
  std::set<std::string> present;
  std::vector<std::string> candidates;
  for (; entries != fs::directory_iterator(); entries.increment(failed)) {
    const std::string name = entries->path().filename().string();
    if (is_temporary_name(name) || name == "done" || name == "failed") continue;
    present.insert(name);
    Seen& seen = seen_[name];
    if (!note_file(entries->path(), seen, now_s, found) || seen.refused_until_s > now_s) continue;
    candidates.push_back(name);
  }
  if (failed) cannot_read(folder_, failed.value());
  std::erase_if(seen_, [&](const auto& item) { return !present.contains(item.first); });
  std::vector<std::tuple<std::int64_t, std::string>> ripe;  // when it was last changed, name
  for (const std::string& name : candidates) {
    Seen& seen = seen_.at(name);
    disk_answered();
    if (is_settings_name(name)) {
      tell_if_alone(name, seen, now_s, found);
      continue;
    }
    next_look_s_ = std::min(next_look_s_, now_s + kPendingLook_s);
    if (is_ripe(folder_ / name, seen, now_s) && are_settings_ripe(name, now_s))
      ripe.emplace_back(seen.changed_ns, name);
  }
  std::sort(ripe.begin(), ripe.end());
  for (const auto& [modified_ns, name] : ripe) found.whole.push_back(folder_ / name);
}

// False for what is not a file that may be taken.
bool WatchFolder::note_file(const fs::path& path, Seen& seen, double now_s, Found& found) const {
  struct stat status {};
  const bool is_there = ::lstat(path.c_str(), &status) == 0;
  disk_answered();
  if (!is_there) return false;
  if (const std::string reason = reason_to_ignore(status); !reason.empty()) {
    if (!seen.told) found.ignored.push_back({path, reason});
    seen.told = true;
    return false;
  }
  if (!seen.is_of(status)) {
    seen.inode = status.st_ino;
    seen.size = status.st_size;
    seen.changed_ns = modified_ns(status);
    seen.still_since_s = now_s;
    seen.refused_until_s = 0;
    seen.refusals = 0;
  }
  return true;
}

bool WatchFolder::Seen::is_of(const struct stat& status) const {
  return inode == status.st_ino && size == status.st_size && changed_ns == modified_ns(status);
}

bool WatchFolder::is_as_seen(const fs::path& path) const {
  struct stat status {};
  const auto found = seen_.find(path.filename().string());
  return found != seen_.end() && ::lstat(path.c_str(), &status) == 0 && found->second.is_of(status);
}

bool WatchFolder::is_still_whole(const fs::path& path, double now_s) const {
  const std::string name = path.filename().string();
  return is_as_seen(path) && is_ripe(path, seen_.at(name), now_s) &&
         (!has_settings_beside(path) || is_as_seen(settings_beside(path))) &&
         are_settings_ripe(name, now_s);
}

// A model waits for its settings file while that is still being written.
bool WatchFolder::are_settings_ripe(const std::string& model, double now_s) const {
  const fs::path settings = settings_beside(folder_ / model);
  const auto found = seen_.find(settings.filename().string());
  if (found == seen_.end() || found->second.size < 0) return true;
  return now_s - found->second.still_since_s >= rules_.still_s && !is_being_written(settings);
}

// A settings file is taken with its model. One that lies here by itself was meant for something.
void WatchFolder::tell_if_alone(const std::string& name, Seen& seen, double now_s,
                                Found& found) const {
  const std::string model = fs::path(name).stem().string();
  if (seen.told || seen_.contains(model) || now_s - seen.still_since_s < rules_.give_up_s) return;
  seen.told = true;
  found.ignored.push_back({folder_ / name, "it is a settings file, and " + printable(model) +
                                               ", which it is named after, is not here. It "
                                               "counts once that is dropped too."});
}

bool WatchFolder::is_ripe(const fs::path& path, const Seen& seen, double now_s) const {
  const double still_s = now_s - seen.still_since_s;
  if (still_s < rules_.still_s) return false;
  if (still_s >= std::max(rules_.give_up_s, rules_.still_s)) return true;
  const bool is_open = is_being_written(path);
  disk_answered();
  if (is_open) return false;
  switch (file_is_whole(path)) {
    case Whole::kYes:
      return true;
    case Whole::kNo:
      return false;
    case Whole::kUnknown:
      return seen.closed || still_s >= 3 * rules_.still_s;
  }
  return false;
}

double WatchFolder::refuse(const fs::path& path, double now_s, double retry_s) {
  const auto found = seen_.find(path.filename().string());
  if (found == seen_.end()) return retry_s;
  Seen& seen = found->second;
  const double pause_s = backoff_s(retry_s, seen.refusals++);
  seen.refused_until_s = now_s + pause_s;
  return pause_s;
}

}  // namespace packmerger
