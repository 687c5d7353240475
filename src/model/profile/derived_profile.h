// Writing a profile that changes another one.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "model/printer.h"

namespace packmerger {

struct ProfileBase {
  std::string id;
  Profile profile;
};

// What a profile in the new file `file` can name as its base in order to change what id_or_path
// says: that profile's id or, since a base has no base of its own, the id of its base. Nothing
// where that name would find another file, or the new one itself. Throws as read_profile().
std::optional<ProfileBase> base_for(std::string_view id_or_path, const std::filesystem::path& file);

// A profile that names `base` and holds the keys alone whose values are others than there. notes:
// by a key's name, the comment beside it. The id is what the file is called.
std::string derived_profile_toml(const Profile& profile, const ProfileBase& base,
                                 const std::map<std::string, std::string>& notes);

}  // namespace packmerger
