// A body on its way to the disk.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string_view>
#include <vector>

#include "base/descriptor.h"
#include "http/message.h"

namespace packmerger {

// The files of one request. Those still there when it dies are removed.
class Upload {
 public:
  Upload(std::filesystem::path folder, std::uint64_t most_bytes, std::uint64_t spare_bytes)
      : folder_(std::move(folder)), most_bytes_(most_bytes), spare_bytes_(spare_bytes) {}
  Upload(const Upload&) = delete;
  Upload& operator=(const Upload&) = delete;
  ~Upload();

  // Each returns 0, or the status of the answer that says why it could not be done: 413 (more than
  // most_bytes), 507 (no room), 500 (cannot be written).
  int begin(std::string_view field, std::string_view name);  // ends the file before
  int write(std::string_view bytes);
  int end();  // the last file's bytes are on the disk

  const std::vector<UploadedFile>& files() const { return files_; }

  // Whether `bytes` more would leave spare_bytes free. True where nobody can tell.
  static bool has_room(const std::filesystem::path& folder, std::uint64_t bytes,
                       std::uint64_t spare_bytes);

 private:
  std::filesystem::path folder_;
  std::uint64_t most_bytes_;
  std::uint64_t spare_bytes_;
  std::uint64_t written_ = 0;  // of all files
  std::uint64_t looked_at_ = 0;
  std::optional<Descriptor> file_;
  std::vector<UploadedFile> files_;
};

}  // namespace packmerger
