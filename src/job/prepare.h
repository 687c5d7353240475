// The whole path: model files → a job folder that can be printed.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "base/progress.h"
#include "job/plan.h"
#include "model/job.h"

namespace packmerger {

enum class Variant { kPacked, kHollow, kSolid, kCheapest };

// Writes the job folder `out` (docs/JOB_FOLDER.md) and returns what it tells. `out` must not exist
// yet, which is looked at first; it is whole or absent afterwards. Throws what plan() throws,
// Error{kBadInput} when the wanted variant fits no tray, Error{kUnavailable} when the slicer is
// missing, Error{kCannotWrite}.
Job prepare(const Profile& profile, const PlanOptions& options, Variant variant,
            const std::filesystem::path& out, const Progress& progress);

// The cheapest way that fits among packed, hollow and solid; empty where none does. Ties go to the
// way with less gluing: solid, then hollow, then packed.
std::optional<Variant> cheapest(const Comparison& comparison);

}  // namespace packmerger
