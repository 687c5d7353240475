#include "daemon/intake/beside.h"

#include <algorithm>
#include <array>

#include "base/names.h"
#include "base/storage/move_file.h"

namespace packmerger {
namespace {

constexpr std::size_t kMaxName = 255;  // bytes of a file's name on Linux
constexpr std::string_view kPicture = ".preview.png";
constexpr std::string_view kSettings = ".toml";
constexpr std::array<std::string_view, 4> kBeside = {kReasonNote, kResultNote, kPicture, kSettings};

}  // namespace

fs::path note_beside(const fs::path& file, std::string_view suffix) {
  return file.parent_path() /
         (first_bytes(file.filename().string(), kMaxName - suffix.size()) + std::string(suffix));
}

fs::path picture_beside(const fs::path& file) { return note_beside(file, kPicture); }

fs::path settings_beside(const fs::path& model) { return note_beside(model, kSettings); }

bool is_settings_name(std::string_view name) {
  return name.size() > kSettings.size() && name.ends_with(kSettings);
}

bool has_settings_beside(const fs::path& model) {
  std::error_code ignored;
  return fs::is_regular_file(fs::symlink_status(settings_beside(model), ignored));
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

}  // namespace packmerger
