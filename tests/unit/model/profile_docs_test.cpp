// docs/PROFILES.md says of every key what the program does.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <set>
#include <sstream>

#include "base/files.h"
#include "model/printer.h"

namespace packmerger {
namespace {

std::string shown_default(const ProfileKey& key) {
  if (key.default_value == "required") return "required";
  if (key.default_value.empty() || key.default_value == "\"\"" || key.default_value == "[]")
    return "none";
  return "`" + key.default_value + "`";
}

std::string row_of(const ProfileKey& key) {
  return "| `" + key.name + "` | " + key.type + " | " + key.unit + " | " + key.range + " | " +
         shown_default(key) + " | " + key.meaning + " |";
}

TEST(ProfileDocs, ListEveryKeyAndNoOther) {
  const char* source = std::getenv("PACKMERGER_SOURCE");
  const fs::path docs = fs::path(source == nullptr ? "." : source) / "docs/PROFILES.md";
  std::istringstream text(read_file(docs, 1 << 20));
  std::set<std::string> rows;
  for (std::string line; std::getline(text, line);)
    if (line.starts_with("| `")) rows.insert(line);
  std::set<std::string> expected;
  for (const ProfileKey& key : profile_keys()) {
    EXPECT_FALSE(key.meaning.empty());
    EXPECT_TRUE(key.meaning.ends_with(".")) << key.name;
    expected.insert(row_of(key));
  }
  for (const std::string& row : expected) EXPECT_TRUE(rows.contains(row)) << "missing: " << row;
  for (const std::string& row : rows) EXPECT_TRUE(expected.contains(row)) << "not so: " << row;
}

}  // namespace
}  // namespace packmerger
