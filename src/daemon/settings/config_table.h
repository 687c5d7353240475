// Reading one table of the daemon's settings. For config.cpp only.
#pragma once

#include <toml++/toml.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include "daemon/settings/config.h"

namespace packmerger {

// Throws Error{kBadProfile} "FILE:LINE: what".
[[noreturn]] void refuse(const std::filesystem::path& file, int line, const std::string& what);

int line_of(const toml::node& node);

// Walks one table: every key is named once, with what it takes; a key nobody named is an error.
// Without a table it only collects the names, for daemon_keys().
class TableReader {
 public:
  TableReader(const std::filesystem::path& file, const toml::table* table, std::string prefix,
              std::vector<DaemonKey>* keys)
      : file_(file), table_(table), prefix_(std::move(prefix)), keys_(keys) {}

  // take(node) returns false for a value of the wrong type or out of its range.
  void key(const std::string& name, const std::string& expected,
           const std::function<bool(const toml::node&)>& take);
  void number(const std::string& name, double least, double most, const std::string& expected,
              const std::function<void(double)>& set);
  void integer(const std::string& name, std::int64_t least, std::int64_t most,
               const std::string& expected, const std::function<void(std::int64_t)>& set);
  // A text that is not empty and holds no zero byte.
  void text(const std::string& name, const std::string& expected,
            const std::function<bool(const std::string&)>& set);
  void flag(const std::string& name, const std::function<void(bool)>& set);

  // After the last key: refuses what is left.
  void done() const;

 private:
  const std::filesystem::path& file_;
  const toml::table* table_;
  std::string prefix_;
  std::vector<DaemonKey>* keys_;
  std::set<std::string> known_;
};

}  // namespace packmerger
