// The whole path: model files → a job folder that can be printed.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "base/progress.h"
#include "job/compare/advice.h"
#include "job/plan.h"
#include "model/compared_ways.h"
#include "model/job.h"

namespace packmerger {

// Writes the job folder `out` (docs/JOB_FOLDER.md) and returns what it tells. `out` must not exist
// yet, which is looked at first; it is whole or absent afterwards. Where `known` compared the same,
// nothing is compared again, and the folder is the same but for timings_s. Throws what plan()
// throws, Error{kBadInput} when the wanted variant fits no tray, Error{kUnavailable} when the
// slicer is missing, Error{kCannotWrite}.
Job prepare(const Profile& profile, const PlanOptions& options, Variant variant,
            const std::filesystem::path& out, const Progress& progress,
            const std::optional<KnownWays>& known = {});

}  // namespace packmerger
