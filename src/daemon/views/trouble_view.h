// What fails again and again as people and programs are shown it; docs/DAEMON.md names the keys.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "base/trouble.h"

namespace packmerger {

// Null: there is none.
nlohmann::json trouble_view(const std::optional<Trouble>& trouble);

// Each with `about`.
nlohmann::json list_of(const Troubles& troubles);

// All in one line; empty: there are none.
std::string words_of(const Troubles& troubles);

}  // namespace packmerger
