// One printer's watched folder: finds the files that people put into it, and says when each is
// whole. It only looks; whoever owns the jobs takes the files.
#pragma once

#include <sys/stat.h>

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/settings/config.h"

namespace packmerger {

// .*, ~*, *.part, *.tmp, *.crdownload, *.filepart: names of files that are not there yet.
bool is_temporary_name(std::string_view name);

class WatchFolder {
 public:
  // Makes the folder where it is missing. The watch (inotify(7)) is set before the folder is first
  // read, so that nothing falls between. Throws Error{kCannotWrite} when it cannot be made,
  // Error{kIo} when it cannot be read.
  WatchFolder(std::filesystem::path folder, const WatchConfig& rules);
  WatchFolder(const WatchFolder&) = delete;
  WatchFolder& operator=(const WatchFolder&) = delete;
  ~WatchFolder();

  const std::filesystem::path& folder() const { return folder_; }
  int fd() const { return inotify_; }  // readable when something happened

  struct Ignored {
    std::filesystem::path path;
    std::string reason;
  };
  struct Found {
    std::vector<std::filesystem::path> whole;  // ready to be taken, oldest first
    // told once each: symbolic links, devices, folders, settings files without their model
    std::vector<Ignored> ignored;
  };

  // Reads what happened and, when it is time, the folder. now_s: a clock that never goes back.
  // A file stays in `whole` of every call until it is gone, or refused. A settings file
  // (model_options.h) is never in it: whoever takes its model takes it too. A model waits while its
  // settings file changes.
  // Throws Error{kIo} while the folder cannot be read.
  Found look(double now_s);

  // Whether a file that look() found whole, and the settings beside it, are still as they were.
  bool is_still_whole(const std::filesystem::path& path, double now_s) const;

  // The file could not be taken: it is offered again after retry_s, doubled each further time, or
  // once it changed. Returns how long that is.
  double refuse(const std::filesystem::path& path, double now_s, double retry_s);

  // When look() has to be called although fd() stays silent.
  double next_look_s() const { return next_look_s_; }

 private:
  struct Seen {
    std::uint64_t inode = 0;
    std::int64_t size = -1;
    std::int64_t changed_ns = 0;
    double still_since_s = 0;
    double refused_until_s = 0;
    int refusals = 0;
    bool closed = false;  // its writer closed it, or it was moved here
    bool told = false;    // that it is ignored
    bool is_of(const struct stat& status) const;
  };

  bool is_as_seen(const std::filesystem::path& path) const;
  void set_watch();
  bool read_events();
  void read_folder(double now_s, Found& found);
  bool note_file(const std::filesystem::path& path, Seen& seen, double now_s, Found& found) const;
  bool are_settings_ripe(const std::string& model, double now_s) const;
  void tell_if_alone(const std::string& name, Seen& seen, double now_s, Found& found) const;
  bool is_ripe(const std::filesystem::path& path, const Seen& seen, double now_s) const;

  std::filesystem::path folder_;
  WatchConfig rules_;
  int inotify_ = -1;
  int watch_ = -1;
  std::uint64_t watched_inode_ = 0;
  std::map<std::string, Seen> seen_;  // by name
  double next_look_s_ = 0;
};

}  // namespace packmerger
