#include "model/printer.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <optional>
#include <set>

#include "base/error.h"
#include "base/process/process.h"
#include "model/profile/derived_profile.h"
#include "model/profile/near_profile.h"
#include "model/profile/profile_file.h"
#include "model/profile/profile_keys.h"

namespace packmerger {
namespace {

namespace fs = std::filesystem;

std::optional<fs::path> environment_folder(const char* name) {
  const char* value = std::getenv(name);
  if (value == nullptr || *value == '\0') return std::nullopt;
  return fs::path(value);
}

// Empty when no folder has it.
fs::path find_profile(const std::string& id, const std::vector<fs::path>& folders) {
  for (const fs::path& folder : folders) {
    fs::path candidate = folder / (id + ".toml");
    std::error_code ignored;
    if (fs::is_regular_file(candidate, ignored)) return candidate;
  }
  return {};
}

// A base is looked for beside the profile that names it before anywhere else.
fs::path find_base(const std::string& id, const fs::path& named_in) {
  std::vector<fs::path> folders = profile_folders();
  folders.insert(folders.begin(), named_in.has_parent_path() ? named_in.parent_path() : ".");
  return find_profile(id, folders);
}

fs::path base_path(const ProfileFile& file) {
  const fs::path path = find_base(*file.base(), file.path());
  if (path.empty())
    file.refuse(file.base_line(),
                fmt::format("the base profile \"{}\" is not there", *file.base()));
  return path;
}

void check_complete(const Profile& profile, const ProfileFile& file,
                    const std::set<std::string>& seen) {
  Profile names_only;
  for (const Key& key : keys_of(names_only))
    if (key.required && !seen.contains(key.name))
      file.refuse(1, fmt::format("the key {} is missing: expected {}", key.name, expected(key)));
  if (const std::string missing = missing_for_abilities(profile); !missing.empty())
    file.refuse(1, missing);
}

std::string what_there_is(const std::string& id) {
  const std::vector<std::string> ids = profile_ids();
  if (ids.empty())
    return "No profiles are installed. Install PackMerger again, or name the folder that holds "
           "them "
           "in PACKMERGER_PROFILES.";
  return fmt::format(
      "{}There are {}. For another printer write a profile of your own on the base of "
      "the nearest (docs/PROFILES.md); its path must contain a slash or end in .toml.",
      near_profile(id, ids), fmt::join(ids, ", "));
}

// Where an id or a path, as read_profile() takes it, is read from.
fs::path profile_path(std::string_view id_or_path) {
  if (id_or_path.find('/') != std::string_view::npos || id_or_path.ends_with(".toml"))
    return id_or_path;
  const std::string id(id_or_path);
  fs::path path = is_profile_id(id) ? find_profile(id, profile_folders()) : fs::path();
  if (path.empty())
    throw Error(Fault::kNoInput, fmt::format("There is no profile \"{}\"", id), what_there_is(id));
  return path;
}

Profile read_profile_file(const fs::path& path) {
  const ProfileFile file(path);
  Profile profile;
  std::set<std::string> seen;
  if (file.base()) {
    const ProfileFile parent(base_path(file));
    if (parent.base()) file.refuse(file.base_line(), "a base may not have a base of its own");
    parent.apply(profile, seen);
    profile.id.clear();
  }
  file.apply(profile, seen);
  if (profile.id.empty()) profile.id = path.stem().string();
  if (!is_profile_id(profile.id))
    file.refuse(1, "a profile's file is named with letters, digits, \"-\", \"_\" and \".\" alone");
  check_complete(profile, file, seen);
  return profile;
}

std::vector<std::string> split(std::string_view list, char at = ',') {
  std::vector<std::string> items;
  while (!list.empty()) {
    const std::size_t comma = std::min(list.find(at), list.size());
    items.emplace_back(list.substr(0, comma));
    list.remove_prefix(std::min(comma + 1, list.size()));
  }
  return items;
}

template <typename Number>
std::optional<Number> number_from(std::string_view text) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

// "0x0,200x0,200x200": as slicers write their plates.
std::optional<Polygon> points_from(std::string_view text) {
  Polygon polygon;
  for (const std::string& point : split(text)) {
    const std::size_t cross = point.find('x');
    if (cross == std::string::npos) return std::nullopt;
    const auto x = number_from<double>(std::string_view(point).substr(0, cross));
    const auto y = number_from<double>(std::string_view(point).substr(cross + 1));
    if (!x || !y) return std::nullopt;
    polygon.emplace_back(*x, *y);
  }
  return polygon;
}

// What the text of a --set is for this kind of key; empty when it is nothing of the kind.
struct RawFromText {
  std::string_view text;

  std::optional<RawValue> operator()(const NumberKey&) const { return number_from<double>(text); }
  std::optional<RawValue> operator()(const IntegerKey&) const {
    return number_from<std::int64_t>(text);
  }
  std::optional<RawValue> operator()(const TextKey&) const { return std::string(text); }
  std::optional<RawValue> operator()(const ChoiceKey&) const { return std::string(text); }
  std::optional<RawValue> operator()(const PolygonKey&) const {
    if (text.empty()) return std::vector<std::string>{};
    const std::optional<Polygon> points = points_from(text);
    return points ? std::optional<RawValue>(*points) : std::nullopt;
  }
  std::optional<RawValue> operator()(const PolygonsKey&) const {
    std::vector<Polygon> polygons;
    for (const std::string& one : split(text, ';')) {
      const std::optional<Polygon> points = points_from(one);
      if (!points) return std::nullopt;
      polygons.push_back(*points);
    }
    return polygons;
  }
  std::optional<RawValue> operator()(const TextsKey&) const { return split(text); }
  std::optional<RawValue> operator()(const TextTableKey&) const { return std::nullopt; }
  std::optional<RawValue> operator()(const Numbers3Key&) const {
    std::vector<double> numbers;
    for (const std::string& item : split(text)) {
      const auto number = number_from<double>(item);
      if (!number) return std::nullopt;
      numbers.push_back(*number);
    }
    return numbers;
  }
};

[[noreturn]] void refuse_setting(const std::string& what) {
  throw Error(Fault::kUsage, what,
              "Write key=value; docs/PROFILES.md lists every key with its type, unit and range.");
}

}  // namespace

std::vector<fs::path> profile_folders() {
  std::vector<fs::path> folders;
  if (const auto chosen = environment_folder("PACKMERGER_PROFILES")) folders.push_back(*chosen);
  if (const auto config = environment_folder("XDG_CONFIG_HOME"))
    folders.push_back(*config / "packmerger/profiles");
  else if (const auto home = environment_folder("HOME"))
    folders.push_back(*home / ".config/packmerger/profiles");
  folders.emplace_back("/etc/packmerger/profiles");
  folders.emplace_back("/usr/share/packmerger/profiles");
  // A program that still lies in its build folder is not installed.
  if (fs::exists(program_folder().parent_path() / "CMakeCache.txt"))
    folders.emplace_back(PACKMERGER_SOURCE_PROFILES);
  return folders;
}

Profile read_profile(std::string_view id_or_path) {
  const fs::path path = profile_path(id_or_path);
  Profile profile = read_profile_file(path);
  if (path != fs::path(id_or_path) && profile.id != id_or_path)
    ProfileFile(path).refuse(
        1, fmt::format("its id is \"{}\", which is not the file's name", profile.id));
  return profile;
}

std::optional<ProfileBase> base_for(std::string_view id_or_path, const fs::path& file) {
  fs::path root = profile_path(id_or_path);
  if (const ProfileFile given(root); given.base()) root = base_path(given);
  const std::string id = root.stem().string();
  if (!is_profile_id(id) || file.stem() == id) return std::nullopt;
  std::error_code ignored;
  if (!fs::equivalent(find_base(id, file), root, ignored)) return std::nullopt;
  return ProfileBase{id, read_profile_file(root)};
}

void set_profile_key(Profile& profile, std::string_view assignment) {
  const std::size_t equals = assignment.find('=');
  if (equals == std::string_view::npos)
    refuse_setting(fmt::format("\"{}\" sets nothing", assignment));
  const std::string name(assignment.substr(0, equals));
  const std::string_view text = assignment.substr(equals + 1);

  for (const Key& key : keys_of(profile)) {
    std::optional<RawValue> value;
    if (key.name == name)
      value = std::visit(RawFromText{text}, key.kind);
    else if (std::holds_alternative<TextTableKey>(key.kind) && name.starts_with(key.name + "."))
      value =
          std::map<std::string, std::string>{{name.substr(key.name.size() + 1), std::string(text)}};
    else
      continue;
    if (!value || !assign(key, *value))
      refuse_setting(fmt::format("{}: expected {}", name, expected(key)));
    return;
  }
  refuse_setting(fmt::format("There is no key \"{}\"", name));
}

void check_settings(const Profile& profile) {
  if (const std::string missing = missing_for_abilities(profile); !missing.empty())
    refuse_setting(missing);
}

std::vector<ProfileKey> profile_keys() {
  Profile names_only;
  std::vector<ProfileKey> rows;
  for (const Key& key : keys_of(names_only))
    rows.push_back({key.name, type_name(key), key.unit, range_text(key), key.meaning,
                    key.required ? "required" : toml_value(key)});
  return rows;
}

std::vector<std::string> profile_ids() {
  std::set<std::string> ids;
  for (const fs::path& folder : profile_folders()) {
    std::error_code ignored;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, ignored))
      if (entry.path().extension() == ".toml" && is_profile_id(entry.path().stem().string()))
        ids.insert(entry.path().stem().string());
  }
  return {ids.begin(), ids.end()};
}

}  // namespace packmerger
