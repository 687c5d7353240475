// What a job does, for people.
#pragma once

#include <string>

#include "daemon/jobs/job_manager.h"

namespace packmerger {

// One short phrase: what the job does or waits for, and what is wrong with its file.
std::string status_text(const JobManager& job_manager, const JobRecord& job);

}  // namespace packmerger
