#include "base/storage/zip_archive.h"

#include <algorithm>
#include <array>

#include <zip.h>

#include "base/error.h"

namespace packmerger {
namespace {

constexpr std::uint64_t kMostRatio = 200;

[[noreturn]] void refuse(const std::string& why) {
  throw Error(Fault::kBadInput, "The file is damaged: " + why, "Export it again.");
}

zip_t* zip_of(void* zip) { return static_cast<zip_t*>(zip); }

}  // namespace

void ZipArchive::Discard::operator()(void* zip) const { zip_discard(zip_of(zip)); }

ZipArchive::ZipArchive(std::string_view bytes, std::uint64_t most_bytes)
    : most_bytes_(std::min(most_bytes, kMostRatio * bytes.size() + (1 << 20))) {
  zip_error_t error;
  zip_error_init(&error);
  zip_source_t* source = zip_source_buffer_create(bytes.data(), bytes.size(), 0, &error);
  if (source != nullptr) {
    zip_.reset(zip_open_from_source(source, ZIP_RDONLY, &error));
    if (!zip_) zip_source_free(source);
  }
  const std::string why = zip_error_strerror(&error);
  zip_error_fini(&error);
  if (!zip_) refuse("its ZIP archive cannot be opened (" + why + ")");
}

bool ZipArchive::looks_like(std::string_view bytes) { return bytes.starts_with("PK\3\4"); }

std::vector<std::string> ZipArchive::names() const {
  std::vector<std::string> names;
  const zip_int64_t count = zip_get_num_entries(zip_of(zip_.get()), 0);
  for (zip_int64_t i = 0; i < count; ++i)
    if (const char* name = zip_get_name(zip_of(zip_.get()), static_cast<zip_uint64_t>(i), 0))
      names.emplace_back(name);
  return names;
}

std::optional<std::string> ZipArchive::entry(const std::string& name) {
  const std::unique_ptr<zip_file_t, int (*)(zip_file_t*)> file(
      zip_fopen(zip_of(zip_.get()), name.c_str(), ZIP_FL_NOCASE), zip_fclose);
  if (!file) return std::nullopt;
  std::string content;
  std::array<char, 1 << 16> block;
  for (;;) {
    const zip_int64_t count = zip_fread(file.get(), block.data(), block.size());
    if (count < 0) refuse("an entry of its ZIP archive is broken");
    if (count == 0) break;
    content.append(block.data(), static_cast<std::size_t>(count));
    if (content.size() > most_bytes_)
      throw Error(Fault::kBadInput, "The ZIP archive unpacks to an implausible size",
                  "Export it again, or export what is in it by itself.");
  }
  most_bytes_ -= content.size();
  return content;
}

}  // namespace packmerger
