#include "model/profile/profile_file.h"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <vector>

#include "base/error.h"
#include "base/files.h"
#include "model/profile/profile_keys.h"

namespace packmerger {
namespace {

constexpr std::uint64_t kMaxProfileBytes = 1 << 20;

int line_of(const toml::node& node) {
  return std::max(1, static_cast<int>(node.source().begin.line));
}

std::optional<Polygon> points_of(const toml::array& array) {
  Polygon polygon;
  for (const toml::node& item : array) {
    const toml::array* pair = item.as_array();
    if (pair == nullptr || pair->size() != 2) return std::nullopt;
    const auto x = (*pair)[0].value<double>();
    const auto y = (*pair)[1].value<double>();
    if (!(*pair)[0].is_number() || !(*pair)[1].is_number() || !x || !y) return std::nullopt;
    polygon.emplace_back(*x, *y);
  }
  return polygon;
}

// [x, y] of corners, or lists of them.
std::optional<RawValue> raw_arrays(const toml::array& array) {
  if (const auto points = points_of(array)) return *points;
  std::vector<Polygon> polygons;
  for (const toml::node& item : array) {
    const toml::array* corners = item.as_array();
    const auto points = corners == nullptr ? std::nullopt : points_of(*corners);
    if (!points) return std::nullopt;
    polygons.push_back(*points);
  }
  return polygons;
}

std::optional<RawValue> raw_array(const toml::array& array) {
  if (!array.empty() && array.front().is_array()) return raw_arrays(array);
  std::vector<double> numbers;
  std::vector<std::string> texts;
  for (const toml::node& item : array) {
    if (const auto number = item.value<double>(); item.is_number() && number)
      numbers.push_back(*number);
    else if (const auto text = item.value_exact<std::string>())
      texts.push_back(*text);
    else
      return std::nullopt;
  }
  if (numbers.empty()) return texts;
  if (texts.empty()) return numbers;
  return std::nullopt;
}

std::optional<RawValue> raw_table(const toml::table& table) {
  std::map<std::string, std::string> texts;
  for (const auto& [name, node] : table) {
    const auto text = node.value_exact<std::string>();
    if (!text) return std::nullopt;
    texts.emplace(name.str(), *text);
  }
  return texts;
}

// Empty for what no key takes: dates, booleans, mixed lists.
std::optional<RawValue> raw_value(const toml::node& node) {
  if (const auto* whole = node.as_integer()) return whole->get();
  if (const auto* number = node.as_floating_point()) return number->get();
  if (const auto* text = node.as_string()) return text->get();
  if (const auto* array = node.as_array()) return raw_array(*array);
  if (const auto* table = node.as_table()) return raw_table(*table);
  return std::nullopt;
}

}  // namespace

struct ProfileFile::Content {
  struct Entry {
    std::string name;
    std::optional<RawValue> value;
    int line = 1;
  };
  std::vector<Entry> entries;
};

ProfileFile::ProfileFile(const std::filesystem::path& path)
    : path_(path), content_(std::make_unique<Content>()) {
  toml::table table;
  try {
    const std::string text = read_file(path, kMaxProfileBytes);
    table = toml::parse(std::string_view(text), path.string());
  } catch (const toml::parse_error& error) {
    refuse(std::max(1, static_cast<int>(error.source().begin.line)),
           std::string(error.description()));
  } catch (const Error& error) {
    if (error.fault() != Fault::kBadInput) throw;
    refuse(1, "no profile is larger than 1 MiB");
  }

  Profile names_only;
  const std::vector<Key> keys = keys_of(names_only);
  const auto is_table_of_keys = [&](const std::string& name) {
    return std::ranges::any_of(keys,
                               [&](const Key& key) { return key.name.starts_with(name + "."); });
  };
  const auto take = [&](const std::string& name, const toml::node& node) {
    content_->entries.push_back({name, raw_value(node), line_of(node)});
  };
  for (const auto& [key, node] : table) {
    const std::string name(key.str());
    if (name == "base") {
      base_line_ = line_of(node);
      base_ = node.value_exact<std::string>();
      if (!base_ || !is_profile_id(*base_)) refuse(base_line_, "base must be another profile's id");
    } else if (!is_table_of_keys(name)) {
      take(name, node);
    } else if (const auto* inner = node.as_table()) {
      for (const auto& [inner_key, inner_node] : *inner)
        take(name + "." + std::string(inner_key.str()), inner_node);
    } else {
      refuse(line_of(node), fmt::format("{} must be a table, [{}]", name, name));
    }
  }
}

ProfileFile::~ProfileFile() = default;

void ProfileFile::apply(Profile& profile, std::set<std::string>& seen) const {
  const std::vector<Key> keys = keys_of(profile);
  for (const Content::Entry& entry : content_->entries) {
    const auto key = std::ranges::find(keys, entry.name, &Key::name);
    if (key == keys.end()) refuse(entry.line, fmt::format("there is no key \"{}\"", entry.name));
    if (!entry.value || !assign(*key, *entry.value))
      refuse(entry.line, fmt::format("{}: expected {}", entry.name, expected(*key)));
    seen.insert(entry.name);
  }
}

void ProfileFile::refuse(int line, const std::string& what) const {
  throw Error(Fault::kBadProfile, fmt::format("{}:{}: {}", path_.string(), line, what),
              "Correct the profile; docs/PROFILES.md lists every key with its type, unit and "
              "range.");
}

}  // namespace packmerger
