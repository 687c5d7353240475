// Messages that could not be delivered, kept for whoever looks for them.
#pragma once

#include <filesystem>
#include <mutex>
#include <string>

namespace packmerger {

// Thread-safe. One JSON object a line: {"at_s", "to", "why", "message"}. Two files of a MiB at
// most: a full one becomes FILE.old.
class DeadLetters {
 public:
  explicit DeadLetters(std::filesystem::path file) : file_(std::move(file)) {}

  // body: JSON text. False where it could not be written.
  bool keep(const std::string& to, const std::string& why, const std::string& body);

 private:
  std::filesystem::path file_;
  std::mutex mutex_;
};

}  // namespace packmerger
