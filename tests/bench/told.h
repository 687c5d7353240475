// What a verb measured, and how it reads the model it measures on.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

#include "job/load_models.h"

namespace packmerger::bench {

// On stdout: as JSON, or a line for each key.
void print_told(const nlohmann::ordered_json& told, bool as_json);

// Its longest side made size_mm long.
LoadedModel load_model(const std::filesystem::path& file, double size_mm);

}  // namespace packmerger::bench
