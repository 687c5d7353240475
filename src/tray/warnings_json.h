// Warnings as job.json has them: [{"code", "text"}].
#pragma once

#include <nlohmann/json.hpp>

#include "model/warning.h"

namespace packmerger {

nlohmann::json warnings_json(const Warnings& warnings);

// The inverse. Throws nlohmann::json::exception.
Warnings warnings_of(const nlohmann::json& json);

}  // namespace packmerger
