// Writing a profile as TOML.
#include <fmt/format.h>

#include <utility>

#include "model/printer.h"
#include "model/profile_keys.h"

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

struct TomlText {
  std::string operator()(const NumberKey& key) const { return fmt::format("{}", *key.value); }
  std::string operator()(const IntegerKey& key) const { return fmt::format("{}", *key.value); }
  std::string operator()(const TextKey& key) const { return toml_string(*key.value); }
  std::string operator()(const ChoiceKey& key) const { return toml_string(key.names[key.get()]); }
  std::string operator()(const Numbers3Key& key) const {
    const auto& [x, y, z] = *key.value;
    return fmt::format("[{}, {}, {}]", x, y, z);
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

}  // namespace

std::string toml_value(const Key& key) { return std::visit(TomlText{}, key.kind); }

std::string profile_toml(const Profile& profile) {
  Profile copy = profile;  // keys are bound to something they could change
  std::string out;
  std::string table;
  std::string sub_tables;  // they must follow the plain keys of their table
  const auto close = [&] { out += std::exchange(sub_tables, {}); };
  for (const Key& key : keys_of(copy)) {
    const std::size_t dot = key.name.find('.');
    const std::string of = dot == std::string::npos ? "" : key.name.substr(0, dot);
    if (of != table) {
      close();
      out += fmt::format("\n[{}]\n", of);
      table = of;
    }
    const std::string value = toml_value(key);
    if (std::holds_alternative<TextTableKey>(key.kind)) {
      sub_tables += fmt::format("\n[{}]\n{}", key.name, value);
      continue;
    }
    const std::string name = dot == std::string::npos ? key.name : key.name.substr(dot + 1);
    out += fmt::format("{} = {}", name, value);
    if (!key.unit.empty()) out += "  # " + key.unit;
    out += '\n';
  }
  close();
  return out;
}

}  // namespace packmerger
