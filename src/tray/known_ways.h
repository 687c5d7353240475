// What a job folder tells of the comparison that it was prepared after.
#pragma once

#include <filesystem>
#include <optional>

#include <nlohmann/json.hpp>

#include "model/compared_ways.h"

namespace packmerger {

// job.json's "compared".
nlohmann::json compared_json(const ComparedWays& compared);

// Nothing where the folder has no readable job.json, an earlier version wrote it, or it is of a
// program.
std::optional<KnownWays> known_ways(const std::filesystem::path& job_folder);

}  // namespace packmerger
