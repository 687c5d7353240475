// A ZIP archive (PKWARE APPNOTE; libzip) in memory, read as nobody trusts it: no name in it is
// ever used as a path on disk.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace packmerger {

class ZipArchive {
 public:
  // `bytes` must outlive the archive. All entries that are read may together unpack to most_bytes,
  // and to 200 times the archive's size: text shrinks to a tenth, bombs to a thousandth. Throws
  // Error{kBadInput} where the archive cannot be opened.
  ZipArchive(std::string_view bytes, std::uint64_t most_bytes);

  // Whether the bytes begin as a ZIP archive does.
  static bool looks_like(std::string_view bytes);

  std::vector<std::string> names() const;
  // The content of an entry, capitals or not; nothing where there is none. Throws
  // Error{kBadInput} where it is broken or unpacks to more.
  std::optional<std::string> entry(const std::string& name);

 private:
  struct Discard {
    void operator()(void* zip) const;
  };
  std::uint64_t most_bytes_;  // that may still be unpacked
  std::unique_ptr<void, Discard> zip_;
};

}  // namespace packmerger
