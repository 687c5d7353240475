// Profile files as TOML. For printer.cpp only.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <string>

#include "model/printer.h"

namespace packmerger {

// One parsed file, before its values are applied.
class ProfileFile {
 public:
  // Error{kBadProfile} with file and line when it is not TOML or holds something no profile has;
  // Error{kNoInput} when it is not there.
  explicit ProfileFile(const std::filesystem::path& path);
  ~ProfileFile();
  ProfileFile(const ProfileFile&) = delete;
  ProfileFile& operator=(const ProfileFile&) = delete;

  const std::filesystem::path& path() const { return path_; }
  const std::optional<std::string>& base() const { return base_; }

  // Sets every key that the file holds, and notes their names in `seen`.
  void apply(Profile& profile, std::set<std::string>& seen) const;

  // Error{kBadProfile}: "FILE:LINE: what".
  [[noreturn]] void refuse(int line, const std::string& what) const;
  int base_line() const { return base_line_; }

 private:
  struct Content;
  std::filesystem::path path_;
  std::unique_ptr<Content> content_;
  std::optional<std::string> base_;
  int base_line_ = 1;
};

}  // namespace packmerger
