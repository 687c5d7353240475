// How far a printer was told to go, on disk while it prints.
#pragma once

#include <chrono>
#include <cstddef>
#include <optional>
#include <string_view>

#include "base/descriptor.h"
#include "base/files.h"

namespace packmerger {

// The printer has acknowledged `done` of `total` lines (G-code) or bytes (x3g) of the program.
struct Told {
  std::size_t done = 0;
  std::size_t total = 0;
};

// One record, written anew with every acknowledgement, the first one before anything is sent. After
// a crash of this program it is exact; after a power cut it may be a second behind, but the first
// one is on the disk at once. Used by one thread.
class ProgressFile {
 public:
  // Makes the file where there is none; its folder is there. Throws Error{kCannotWrite}.
  explicit ProgressFile(fs::path path);

  // To be called at every acknowledgement, and at least once a second besides, so that the last one
  // is put on the disk too. Throws Error{kCannotWrite}.
  void acknowledged(std::size_t done, std::size_t total);

 private:
  void write(std::string_view text) const;
  [[noreturn]] void fail() const;

  fs::path path_;
  Descriptor fd_;
  Told written_;
  bool is_first_ = true;
  bool synced_ = true;
  std::chrono::steady_clock::time_point synced_at_ = std::chrono::steady_clock::now();
};

// Whether nothing of the program was sent: there is no record, not even one that cannot be read.
bool has_sent_nothing(const fs::path& path);

// What the file says; nothing where there is none, where it is no such record, or where the print
// had not begun.
std::optional<Told> read_told(const fs::path& path);

// "line 120 of 300 (40 %)"; unit: "line" or "byte".
std::string told_text(const Told& told, std::string_view unit);

}  // namespace packmerger
