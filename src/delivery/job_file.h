// What a file that people hand in is, and what a job calls it. Folders, uploads and every other
// door go by this.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace packmerger {

enum class FileKind {
  kModel,    // .stl .obj .ply .off .3mf: it is prepared
  kGcode,    // .gcode .gco .g: streamed as it is
  kX3g,      // .x3g .s3g: streamed as it is
  kSliced,   // .gcode.3mf: the program of its one plate is streamed
  kUnknown,  // nothing PackMerger takes
};

// By the name's ending, capitals or not.
FileKind kind_of_file(std::string_view name);
inline bool is_program(FileKind kind) {
  return kind == FileKind::kGcode || kind == FileKind::kX3g || kind == FileKind::kSliced;
}
inline bool is_program(std::string_view name) { return is_program(kind_of_file(name)); }

// The endings that have a kind.
std::vector<std::string_view> job_file_endings();

// The last part of what somebody calls a file, as a plain name in a folder: never a way out of it,
// not hidden, without characters that cannot be shown, at most 200 bytes. Throws Error{kBadInput}
// where nothing is left of it, or its ending is of no kind above.
std::string job_file_name(std::string_view given);

}  // namespace packmerger
