// What a person is told who asks of a job what its state does not know.
#pragma once

#include "job/store/job_store.h"
#include "job/store/job_transitions.h"

namespace packmerger {

// "Job 12".
std::string title_of(const JobRecord& job);

// Throws Error{kUsage}, or kBusy where it can be asked again in a moment: what the job is now, and
// what to do instead.
[[noreturn]] void refuse(const JobRecord& job, JobEventKind event);

}  // namespace packmerger
