// The formats of files that people hand in, as one table: who reads them, watches them being
// written, takes them over the network or names them to people looks here. A mesh format's reader
// registers in shape/read.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace packmerger {

enum class FileKind {
  kModel,    // it is prepared
  kGcode,    // streamed as it is
  kX3g,      // streamed as it is
  kSliced,   // the G-code of its one plate is streamed
  kUnknown,  // nothing PackMerger takes
};

inline bool is_program(FileKind kind) {
  return kind == FileKind::kGcode || kind == FileKind::kX3g || kind == FileKind::kSliced;
}

// By what a file of the format that somebody may still be writing shows that it is whole.
enum class FileEnd {
  kNotTold,
  kStl,  // binary: the length that its count of triangles asks for; ASCII: the last line
  kZip,  // the end record, and that it agrees with the length
};

struct FileFormat {
  std::string_view ending;  // of the name, small letters, with the dot
  FileKind kind;
  std::string_view name;  // for people: "STL"
  FileEnd end;
  std::string_view media_type;  // empty: it is never given away
};

std::span<const FileFormat> file_formats();

// By the name's ending, capitals or not; of several endings the longest. nullptr: none.
const FileFormat* format_of_name(std::string_view name);

inline FileKind kind_of_file(std::string_view name) {
  const FileFormat* format = format_of_name(name);
  return format == nullptr ? FileKind::kUnknown : format->kind;
}
inline bool is_program(std::string_view name) { return is_program(kind_of_file(name)); }

// The names of the models' formats, or of the programs', each once; as a text "STL, OBJ, PLY, OFF,
// 3MF", with last " or " "STL, OBJ, PLY, OFF or 3MF".
std::vector<std::string_view> format_names(bool programs);
std::string model_format_names(std::string_view last = ", ");
std::string program_format_names(std::string_view last = ", ");

}  // namespace packmerger
