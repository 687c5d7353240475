// What a job calls a file that people hand in. Folders, uploads and every other door go by this.
#pragma once

#include <string>
#include <string_view>

namespace packmerger {

// The refusal of what is of no format in model/files/file_format.h: what it is, and what to send
// instead.
inline constexpr const char* kNotTaken = "This is nothing that PackMerger takes";
std::string what_is_taken();

// The last part of what somebody calls a file, as a plain name in a folder: never a way out of it,
// not hidden, without characters that cannot be shown, at most 200 bytes. Throws Error{kBadInput}
// where nothing is left of it, or its ending is of no format.
std::string job_file_name(std::string_view given);

}  // namespace packmerger
