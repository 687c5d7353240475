// Moving a user's files about without ever losing or replacing one.
#pragma once

#include "base/files.h"

namespace packmerger {

enum class Moved { kYes, kOtherFileSystem };

// Whether anything has that name, be it a link to nowhere.
bool is_taken(const fs::path& path);

// Renames from to to, which must not exist, and syncs both folders; folders on the way to `to` are
// made. kOtherFileSystem: nothing was done, copy_file_whole can do it. Throws Error{kNoInput} when
// from is not there, Error{kBusy} when to exists, Error{kCannotWrite} otherwise.
Moved rename_new(const fs::path& from, const fs::path& to);

// Copies through a temporary sibling: afterwards `to`, which must not exist, is whole and synced,
// or absent. Throws as rename_new, and Error{kIo} when from cannot be read. What is copied is
// synced bit by bit, so that no single call waits for all of a large file.
void copy_file_whole(const fs::path& from, const fs::path& to);

// rename_new, or where that is not possible copy_file_whole and then removing from.
void move_new(const fs::path& from, const fs::path& to);

}  // namespace packmerger
