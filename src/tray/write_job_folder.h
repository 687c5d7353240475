// The job folder: everything that is handed on about one job (docs/JOB_FOLDER).
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/files.h"
#include "base/progress.h"
#include "model/job.h"

namespace packmerger {

// What was made for one tray beside its meshes.
struct TrayFiles {
  std::optional<std::string> program_extension;  // "gcode", "x3g"; empty: no program
  std::string program;                           // the program's bytes
};

// Throws Error{kCannotWrite} when there is something at `out` already. For the start of a long work
// whose result goes there.
void check_job_folder(const fs::path& out);

// Writes job.json, profile.toml, tray.3mf, tray.stl, parts/, preview.glb, assembly.glb, page.glb,
// preview.png and the programs into a temporary sibling of `out` and renames it: afterwards `out` is whole, or
// it is absent. trays: one entry per tray, in order. `out` is a path that does not exist in a
// folder that does.
//
// Throws Error{kCannotWrite} when out exists or cannot be written, Error{kBadInput} when a part
// cannot be written as a closed binary STL (its numbers are too large for 32-bit floats),
// Error{kInternal} when the job contradicts itself (a part on a tray that trays does not have).
void write_job_folder(const Job& job, const std::vector<TrayFiles>& trays, const fs::path& out,
                      const Progress& progress);

}  // namespace packmerger
