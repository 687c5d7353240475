// A print that runs, and what finished ones taught, as parts of what a job's and a printer's view
// show.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "daemon/jobs/job_manager.h"
#include "daemon/settings/config.h"

namespace packmerger {

// From 0 to 1; 0 where nobody knows of how much.
double fraction_of(const PrintReport& report);

// Null where nothing is printed. printer: whose print it is; may be null.
nlohmann::json print_view(const LiveJob* live, const PrinterConfig* printer);

// Null where there is none. source: of the estimates that it corrects.
nlohmann::json correction_view(const std::optional<Correction>& correction,
                               const std::string& source);

}  // namespace packmerger
