// What child processes wrote, read as something that anybody may have written: every value has its
// type and a sensible size, or it is refused.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "model/estimate.h"

namespace packmerger {

// Nothing (discarded) where it is no JSON, or nested deeper than anything of ours: writing it again
// would need as much stack.
nlohmann::json parse_child_json(std::string_view text);

// The "estimates" of job.json or compare: ways of printing by name, with figures from 0 up. Throws
// Error{kBadInput} where they are anything else.
void check_estimates(const nlohmann::json& ways);

// What `packmerger compare --json` printed of its one profile: those estimates as JSON text. Throws
// Error{kBadInput}.
std::string compared_estimates(std::string_view out);

// The estimates of a job's row or of a comparison, as check_estimates() lets them pass; nothing
// where the text is none, or a way that fits lacks its time or cost.
std::optional<Comparison> comparison_in(const std::string& estimates);

// A whole number from `least` to `most`, or Error{kBadInput} that names the key.
std::int64_t whole_number_in(const nlohmann::json& object, const char* key, std::int64_t least,
                             std::int64_t most);

// A text without control characters, cut to a sensible length. Throws Error{kBadInput} likewise.
std::string text_in(const nlohmann::json& object, const char* key);

}  // namespace packmerger
