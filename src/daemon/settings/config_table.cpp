#include "daemon/settings/config_table.h"

#include <algorithm>

#include "base/error.h"

namespace packmerger {

void refuse(const std::filesystem::path& file, int line, const std::string& what) {
  throw Error(Fault::kBadProfile, file.string() + ":" + std::to_string(line) + ": " + what,
              "Correct the line; docs/DAEMON.md lists every key.");
}

int line_of(const toml::node& node) {
  return std::max(1, static_cast<int>(node.source().begin.line));
}

void TableReader::key(const std::string& name, const std::string& expected,
                      const std::function<bool(const toml::node&)>& take) {
  known_.insert(name);
  if (keys_ != nullptr) keys_->push_back({prefix_ + name, expected});
  const toml::node* node = table_ != nullptr ? table_->get(name) : nullptr;
  if (node != nullptr && !take(*node))
    refuse(file_, line_of(*node), prefix_ + name + ": expected " + expected);
}

void TableReader::number(const std::string& name, double least, double most,
                         const std::string& expected, const std::function<void(double)>& set) {
  key(name, expected, [&](const toml::node& node) {
    const auto value = node.value<double>();
    if (!node.is_number() || !value || !(*value >= least && *value <= most)) return false;
    set(*value);
    return true;
  });
}

void TableReader::integer(const std::string& name, std::int64_t least, std::int64_t most,
                          const std::string& expected,
                          const std::function<void(std::int64_t)>& set) {
  key(name, expected, [&](const toml::node& node) {
    const auto value = node.value_exact<std::int64_t>();
    if (!value || *value < least || *value > most) return false;
    set(*value);
    return true;
  });
}

void TableReader::text(const std::string& name, const std::string& expected,
                       const std::function<bool(const std::string&)>& set) {
  key(name, expected, [&](const toml::node& node) {
    const auto value = node.value_exact<std::string>();
    return value && !value->empty() && value->find('\0') == std::string::npos && set(*value);
  });
}

void TableReader::flag(const std::string& name, const std::function<void(bool)>& set) {
  key(name, "true or false", [&](const toml::node& node) {
    const auto value = node.value_exact<bool>();
    if (value) set(*value);
    return value.has_value();
  });
}

void TableReader::done() const {
  if (table_ == nullptr) return;
  for (const auto& [name, node] : *table_)
    if (!known_.contains(std::string(name.str())))
      refuse(file_, line_of(node), "unknown key " + prefix_ + std::string(name.str()));
}

}  // namespace packmerger
