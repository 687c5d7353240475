// A printer as people and programs are shown it.
#pragma once

#include <nlohmann/json.hpp>

#include "daemon/jobs/job_manager.h"
#include "daemon/settings/config.h"

namespace packmerger {

// What `printers list` shows; docs/DAEMON.md names the keys.
nlohmann::json printer_view(const JobManager& job_manager, const PrinterConfig& printer);

}  // namespace packmerger
