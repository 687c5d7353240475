// How a job goes from one state to the next: only through the table of job/store/job_transitions.h.
// This changes records in memory; whoever calls writes them into the database, and only then gives
// the order that follows.
#pragma once

#include <functional>
#include <optional>

#include "job/store/job_store.h"
#include "job/store/job_transitions.h"

namespace packmerger {

// Whether the job's state knows the event.
bool is_possible(const JobRecord& job, JobEventKind event);

// Why its next tray could not be begun is no longer of interest.
void forget_tries(JobRecord& job);

class JobSteps {
 public:
  // Told of every step, with the state before it; nothing: there was no such job.
  using Listener = std::function<void(std::optional<JobState> from, JobEventKind event)>;

  // Takes the job to the state that the table names, and changes in its record what the table says.
  // A job that was never stored begins with the event. Throws Error{kInternal} where the table has
  // no such row.
  void apply(JobRecord& job, JobEventKind event) const;

  void listen(Listener listener) { listener_ = std::move(listener); }

 private:
  Listener listener_;
};

}  // namespace packmerger
