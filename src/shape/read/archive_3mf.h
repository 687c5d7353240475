// The ZIP archive of a 3MF file, and the XML in it (Open Packaging Conventions, ECMA-376 part
// 2). Internal to the reader of 3MF.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include <pugixml.hpp>

#include "base/storage/zip_archive.h"

namespace packmerger {

// An entry as a tree, with the text that the tree points into.
struct XmlPart {
  std::string text;
  pugi::xml_document tree;
};

// Entries are read into memory: no name in the archive is ever used as a path on disk. All that is
// read of one archive counts together towards the limits that read_model.h tells.
class Archive3mf {
 public:
  // bytes must outlive the archive. Throws Error{kBadInput} when it is no ZIP archive.
  explicit Archive3mf(std::string_view bytes);

  // Null where there is no such entry; a slash at the beginning of its name does not count.
  // Throws Error{kBadInput}: broken, not well-formed, or beyond the limits.
  std::unique_ptr<XmlPart> part(std::string_view name);

 private:
  ZipArchive zip_;
  double tree_bytes_ = 0;
};

// A name without its prefix.
std::string_view local_name(const char* name);

// The first child of that name, whatever its prefix; null without one.
pugi::xml_node child_named(const pugi::xml_node& node, std::string_view name);

}  // namespace packmerger
