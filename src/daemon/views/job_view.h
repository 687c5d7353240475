// Jobs as people and programs are shown them.
#pragma once

#include <nlohmann/json.hpp>

#include "daemon/jobs/job_manager.h"
#include "job/store/job_store.h"

namespace packmerger {

// What `jobs list` shows, and with history what `jobs show` does; docs/DAEMON.md names the keys.
nlohmann::json job_view(const JobManager& job_manager, const JobRecord& job);
// Its two halves: what the record alone tells, and what also changes while the record stays.
nlohmann::json recorded_view(const JobRecord& job);
nlohmann::json passing_view(const JobManager& job_manager, const JobRecord& job);
nlohmann::json job_view_with_history(const JobManager& job_manager, const JobRecord& job);
// A print that an action starts at once; docs/DAEMON.md names the keys.
nlohmann::json start_view(const JobRecord& job);

}  // namespace packmerger
