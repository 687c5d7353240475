// What is neither a job's nor a printer's, as people and programs are shown it.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "daemon/jobs/job_manager.h"

namespace packmerger {

// The disk of the state folder, and which jobs' folders are deleted.
nlohmann::json storage_view(const JobManager& job_manager);
// What fails again and again, but for that of jobs and printers; docs/DAEMON.md names the keys.
nlohmann::json troubles_view(const JobManager& job_manager);

// What the daemon does, in a line: "2 printers; preparing job 5; job 4 is at lab".
std::string daemon_status(const JobManager& job_manager);

}  // namespace packmerger
