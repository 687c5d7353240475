// The names of what lies beside a user's model: its settings, and what became of it.
#pragma once

#include <string>
#include <string_view>

#include "base/files.h"

namespace packmerger {

inline constexpr std::string_view kReasonNote = ".reason.txt";   // why it failed
inline constexpr std::string_view kResultNote = ".result.json";  // how it was printed

// NAME and what is appended to it, NAME cut so that both have 255 bytes at most.
fs::path note_beside(const fs::path& file, std::string_view suffix);

// NAME.preview.png.
fs::path picture_beside(const fs::path& file);

// "bunny.stl.toml" for "bunny.stl".
fs::path settings_beside(const fs::path& model);
bool is_settings_name(std::string_view name);
// Whether it is there, as a file itself and no link.
bool has_settings_beside(const fs::path& model);

// `folder/name`, or `folder/stem (2).ext` and so on: the first where neither that file nor a note,
// a picture or a settings file beside it are there.
fs::path free_path(const fs::path& folder, const std::string& name);

}  // namespace packmerger
