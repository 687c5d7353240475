// Writing a profile as TOML.
#include <fmt/format.h>

#include <utility>

#include "model/printer.h"
#include "model/profile/derived_profile.h"
#include "model/profile/profile_keys.h"

namespace packmerger {
namespace {

std::string toml_string(const std::string& text) {
  const bool lines = text.find('\n') != std::string::npos;
  // The line end after three quotes is not part of the text.
  std::string out = lines ? "\"\"\"\n" : "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      out += '\\';
      out += c;
    } else if (c == '\t') {
      out += "\\t";
    } else if (c == '\r') {
      out += "\\r";
    } else {
      out += c;
    }
  }
  return out + (lines ? "\"\"\"" : "\"");
}

std::string toml_points(const Polygon& polygon) {
  std::string list;
  for (const Vec2& at : polygon)
    list += fmt::format("{}[{}, {}]", list.empty() ? "" : ", ", at.x(), at.y());
  return "[" + list + "]";
}

struct TomlText {
  std::string operator()(const NumberKey& key) const { return fmt::format("{}", *key.value); }
  std::string operator()(const IntegerKey& key) const { return fmt::format("{}", *key.value); }
  std::string operator()(const TextKey& key) const { return toml_string(*key.value); }
  std::string operator()(const ChoiceKey& key) const { return toml_string(key.names[key.get()]); }
  std::string operator()(const Numbers3Key& key) const {
    const auto& [x, y, z] = *key.value;
    return fmt::format("[{}, {}, {}]", x, y, z);
  }
  std::string operator()(const PolygonKey& key) const { return toml_points(*key.value); }
  std::string operator()(const PolygonsKey& key) const {
    std::string list;
    for (const Polygon& polygon : *key.value)
      list += (list.empty() ? "" : ", ") + toml_points(polygon);
    return "[" + list + "]";
  }
  std::string operator()(const TextsKey& key) const {
    std::string list;
    for (const std::string& text : *key.value)
      list += (list.empty() ? "" : ", ") + toml_string(text);
    return "[" + list + "]";
  }
  std::string operator()(const TextTableKey& key) const {
    std::string lines;
    for (const auto& [name, text] : *key.value) lines += name + " = " + toml_string(text) + "\n";
    return lines;
  }
};

// Keys as lines under the heads of their tables.
class TomlLines {
 public:
  // In the order of keys_of(). The comment may be empty.
  void add(const Key& key, const std::string& comment) {
    const std::size_t dot = key.name.find('.');
    const std::string of = dot == std::string::npos ? "" : key.name.substr(0, dot);
    if (of != table_) {
      close();
      out_ += fmt::format("\n[{}]\n", of);
      table_ = of;
    }
    const std::string value = toml_value(key);
    if (std::holds_alternative<TextTableKey>(key.kind)) {
      sub_tables_ += fmt::format("\n[{}]\n{}", key.name, value);
      return;
    }
    const std::string name = dot == std::string::npos ? key.name : key.name.substr(dot + 1);
    out_ += fmt::format("{} = {}", name, value);
    if (!comment.empty()) out_ += "  # " + comment;
    out_ += '\n';
  }

  std::string text() && {
    close();
    return std::move(out_);
  }

 private:
  void close() { out_ += std::exchange(sub_tables_, {}); }

  std::string out_;
  std::string table_;
  std::string sub_tables_;  // they must follow the plain keys of their table
};

// Leaves what the base does not say already: a table of texts changes its base's entry by entry.
bool differs(const Key& key, const Key& of_base) {
  const auto* table = std::get_if<TextTableKey>(&key.kind);
  if (table == nullptr) return toml_value(key) != toml_value(of_base);
  const std::map<std::string, std::string>& old = *std::get<TextTableKey>(of_base.kind).value;
  std::erase_if(*table->value, [&](const auto& entry) {
    const auto same = old.find(entry.first);
    return same != old.end() && same->second == entry.second;
  });
  return !table->value->empty();
}

}  // namespace

std::string toml_value(const Key& key) { return std::visit(TomlText{}, key.kind); }

std::string profile_toml(const Profile& profile) {
  Profile copy = profile;  // keys are bound to something they could change
  const std::vector<Key> keys = keys_of(copy);
  TomlLines lines;
  for (const Key& key : keys) lines.add(key, key.unit);
  return std::move(lines).text();
}

std::string derived_profile_toml(const Profile& profile, const ProfileBase& base,
                                 const std::map<std::string, std::string>& notes) {
  Profile changed = profile;
  changed.id = base.profile.id;
  Profile old = base.profile;
  const std::vector<Key> keys = keys_of(changed);
  const std::vector<Key> old_keys = keys_of(old);
  TomlLines lines;
  for (std::size_t i = 0; i < keys.size(); ++i) {
    if (!differs(keys[i], old_keys[i])) continue;
    const auto note = notes.find(keys[i].name);
    lines.add(keys[i], note == notes.end() ? keys[i].unit : note->second);
  }
  return fmt::format("base = {}\n", toml_string(base.id)) + std::move(lines).text();
}

}  // namespace packmerger
