// A tray's file in a job folder, which must be there and be what was prepared.
#pragma once

#include <string>

#include "base/files.h"
#include "model/printer.h"

namespace packmerger {

// Its path. Throws Error{kNoInput} where it is not there.
fs::path tray_to_send(const fs::path& folder, const Profile& profile, int tray);

// sha256: of the bytes of `file`. Throws Error{kBadInput} where tray_files (hash_trays() in
// job_folder.h) tells another one of this tray.
void check_hash(const std::string& sha256, const std::string& tray_files, int tray,
                const fs::path& file);

}  // namespace packmerger
