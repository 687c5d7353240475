// The comparison of the ways of printing as JSON, as docs/JOB_FOLDER describes it: mm³, g, s.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "model/estimate.h"

namespace packmerger {

// {"as_is": E, "solid": E, "hollow": E, "packed": E}; where it does not fit, E is
// {"fits": false} with every other figure null, and where it cannot be made "reason" and "hint".
nlohmann::json comparison_json(const Comparison& comparison);

// The inverse of comparison_json(), also of one that an earlier version wrote, without the three
// sums of money. A way that is missing does not fit. Throws nlohmann::json::exception where one
// that fits lacks its time or its cost, or a figure has another type.
Comparison comparison_of(const nlohmann::json& json);

// {"variant": "packed", "hollow", "solid", or null where it fits in no way, "text": a sentence}.
nlohmann::json advice_json(std::string_view variant, const std::string& text);

}  // namespace packmerger
