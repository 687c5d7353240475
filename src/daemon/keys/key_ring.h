// The keys with which programs and browsers may use the daemon's web server.
#pragma once

#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/keys/look_codes.h"

namespace packmerger {

struct WebKey {
  std::string name;         // what people call it
  std::string sha256;       // of the key's text, which is kept nowhere
  double made_s = 0;        // Unix time
  bool looks_only = false;  // it may see everything and change nothing
};

// Thread-safe. Kept in one file, whole or as it was before.
class KeyRing {
 public:
  // Reads the file; there need not be one yet. Throws Error{kIo} where it is damaged: an unreadable
  // list of keys must not count as an empty one.
  explicit KeyRing(std::filesystem::path file);

  // Makes a key of 256 random bits and returns its text, which nobody can tell again. Throws
  // Error{kUsage} for a name that is taken or holds more than letters, digits, "-", "_", "." and
  // spaces, Error{kCannotWrite}.
  std::string add(const std::string& name);
  // A code that look() takes once. now_s: a clock that never goes back.
  std::string add_code(double now_s) { return codes_.add(now_s); }
  // For a code that is still good: makes the key of a page that may look and change nothing, named
  // "page 1" and so on; the oldest of twenty goes. Throws Error{kCannotWrite}.
  std::optional<std::string> look(std::string_view code, double now_s);
  // Throws Error{kNoInput} where there is none of that name.
  void revoke(const std::string& name);

  std::vector<WebKey> list() const;
  // Whether there is none that may change something.
  bool empty() const;

  // Which key a text is. Takes as long for a wrong key as for a right one.
  std::optional<WebKey> find(std::string_view text) const;

 private:
  // Writes the keys down, and only then counts by them.
  void keep(std::vector<WebKey> keys);
  // Keeps these and a new one, whose text begins with `beginning`. Returns that text.
  std::string keep_with(std::vector<WebKey> keys, const std::string& name,
                        const std::string& beginning, bool looks_only);

  std::filesystem::path file_;
  mutable std::mutex mutex_;  // guards keys_
  std::vector<WebKey> keys_;
  LookCodes codes_;
};

}  // namespace packmerger
