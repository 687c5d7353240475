// The job folder of a program that somebody else made: no model, no parts, no pictures
// (docs/JOB_FOLDER).
#pragma once

#include <optional>
#include <string>

#include "base/files.h"
#include "model/estimate.h"
#include "model/printer.h"
#include "model/warning.h"

namespace packmerger {

struct ReadyProgram {
  std::string file;       // its name as it was given, without folders
  std::string sha256;     // of the given file
  Profile profile;        // as used, --set included
  std::string extension;  // "gcode" or "x3g": what is sent
  std::string bytes;      // what is sent: the given bytes themselves unless `converted`
  bool converted = false;
  std::string made_by;  // the slicer; empty where the program does not tell
  Estimate estimate;
  bool material_known = false;  // otherwise the estimate's masses, volumes and cost say nothing
  Warnings warnings;
};

// Writes job.json, profile.toml and the program into a temporary sibling of `out` and renames it:
// `out` is whole or absent. Throws Error{kCannotWrite} when out exists or cannot be written.
void write_program_folder(const ReadyProgram& program, const fs::path& out);

// What write_program_folder() puts into job.json.
std::string program_report(const ReadyProgram& program);

}  // namespace packmerger
