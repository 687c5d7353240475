#include "daemon/state_folder.h"

#include <sys/stat.h>

#include <cerrno>
#include <cstring>

#include "base/error.h"

namespace packmerger {
namespace {

namespace fs = std::filesystem;

constexpr mode_t kOwner = 0700;
constexpr mode_t kOwnerAndGroup = 0750;
constexpr mode_t kOthers = 0007;
constexpr mode_t kAllButOwner = 0077;

[[noreturn]] void cannot_make(const fs::path& folder, int why) {
  throw Error(Fault::kCannotWrite,
              "Cannot make the state folder " + folder.string() + ": " + std::strerror(why),
              "Name another one in the settings (state), or make it writable.");
}

void make(const fs::path& folder, mode_t mode) {
  if (::mkdir(folder.c_str(), mode) == 0) return;
  const int why = errno;
  if (why != EEXIST || !fs::is_directory(folder)) cannot_make(folder, why);
}

mode_t mode_of(const fs::path& path) {
  struct stat status {};
  return ::stat(path.c_str(), &status) == 0 ? status.st_mode & 07777 : 0;
}

// True where something had to be taken away.
bool take_away(const fs::path& path, mode_t rights) {
  const mode_t mode = mode_of(path);
  return (mode & rights) != 0 && ::chmod(path.c_str(), mode & ~rights) == 0;
}

}  // namespace

std::vector<std::string> furnish_state_folder(const fs::path& named) {
  // with a slash at its end, what lies above it would be the folder itself
  const fs::path state = named.has_filename() ? named : named.parent_path();
  std::error_code failed;
  if (state.has_parent_path()) fs::create_directories(state.parent_path(), failed);
  if (failed) cannot_make(state, failed.value());
  make(state, kOwner);
  make(state / "jobs", mode_of(state) & kOwnerAndGroup);
  std::vector<std::string> told;
  for (const auto& [name, rights] : {std::pair{"jobs", kOthers}, {"keys.json", kAllButOwner}})
    if (take_away(state / name, rights))
      told.push_back((state / name).string() + " could be read by others, and is closed now");
  if ((mode_of(state) & kOthers) != 0)
    told.push_back("others may enter the state folder: chmod o-rwx " + state.string() +
                   ", unless people outside its group drop models there");
  return told;
}

}  // namespace packmerger
