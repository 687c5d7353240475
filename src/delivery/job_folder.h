// What the daemon and `send` need to know of a prepared job folder (docs/JOB_FOLDER).
#pragma once

#include <string>
#include <string_view>

#include "base/files.h"
#include "model/printer.h"

namespace packmerger {

// The variant of a job that is somebody else's program, printed as it is.
inline constexpr std::string_view kProgramVariant = "program";

// What to do where the files of a job folder are not what they were.
inline constexpr const char* kPrepareAnew =
    "Have it prepared anew: drop its file again, or run packmerger prepare.";

struct PreparedJob {
  int trays = 1;
  std::string title;               // the first input's name without its ending
  std::string input_sha256;        // of the first input
  std::string profile;             // its id
  std::int64_t seed = 0;           // 0 for a program
  std::string variant = "packed";  // what was prepared: packed, hollow, solid or program
  std::string estimates;           // job.json's "estimates", JSON text
  double predicted_s = 0;          // by the estimate of that variant; 0: none
  std::string predicted_by;        // its source
  std::string warning;             // a program's first one, a model's of its size; empty: none
};

// Throws Error{kNoInput} when folder is no job folder, Error{kBadInput} when its job.json is not
// what docs/JOB_FOLDER says.
PreparedJob read_prepared(const fs::path& folder);

// The profile the folder was prepared with.
Profile read_prepared_profile(const fs::path& folder);

// Why somebody should look at the job before it is printed: a model that was not prepared in the
// way that advice() names (and which that is), or whose unit may be wrong; a program with a
// warning. Empty: nothing speaks against printing it.
std::string doubt_about(const PreparedJob& job);

// For each tray in turn what its printer is given and the SHA-256 of its bytes, JSON text:
// [{"file": "program.gcode", "sha256": "…"}]. Throws Error{kNoInput} where one is not there.
std::string hash_trays(const fs::path& folder, int trays);

// The SHA-256 of a tray's bytes in what hash_trays() gave; empty where that is empty. Throws
// Error{kBadInput} where it does not tell of this tray.
std::string hash_of_tray(const std::string& tray_files, int tray);

}  // namespace packmerger
