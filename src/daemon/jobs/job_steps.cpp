#include "daemon/jobs/job_steps.h"

#include "base/error.h"
#include "base/time/wall_clock.h"

namespace packmerger {
namespace {

// No job has this id before it is stored.
std::optional<JobState> state_of(const JobRecord& job) {
  return job.id == 0 ? std::nullopt : std::optional(job.state);
}

// Its figures stay until there are new ones.
void forget_prepared(JobRecord& job) {
  job.trays = 0;
  job.tray_files.clear();
  job.variant.clear();
  job.cut_short = 0;
  job.approved = job.at_once = job.pays = false;
  job.reason.clear();
  job.hint.clear();
  job.doubt.clear();
  forget_tries(job);
}

void begin_tray(JobRecord& job) {
  job.reason.clear();
  job.hint.clear();
  job.told = job.told_total = 0;
  if (job.sending_s == 0) job.sending_s = unix_now_s();
}

void end(JobRecord& job) {
  job.ended_s = unix_now_s();
  job.filing_done = job.input.empty();
  forget_tries(job);
}

void approve(JobRecord& job) {
  job.approved = true;
  job.reason.clear();
}

void act(JobRecord& job, JobAction action) {
  switch (action) {
    case JobAction::kNothing:
    case JobAction::kForgetJob:  // there is no record to change any more
      return;
    case JobAction::kCopy:
      job.by_copy = true;
      return;
    case JobAction::kCountAttempt:
      ++job.attempt;
      return;
    case JobAction::kForgetPrepared:
      return forget_prepared(job);
    case JobAction::kForgetDeaths:
      job.cut_short = 0;
      return;
    case JobAction::kForgetTries:
      return forget_tries(job);
    case JobAction::kApprove:
      return approve(job);
    case JobAction::kApproveByHand:
      approve(job);
      job.at_once = job.held = false;
      return;
    case JobAction::kHold:
      job.held = true;
      return;
    case JobAction::kRelease:
      job.held = false;
      return;
    case JobAction::kReleaseToPrint:
      job.at_once = job.held = false;
      job.reason.clear();
      return;
    case JobAction::kBeginTray:
      return begin_tray(job);
    case JobAction::kNextTray:
      ++job.next_tray;
      job.cut_short = 0;
      return;
    case JobAction::kNoteCancel:
      job.reason = "cancelling";
      return;
    case JobAction::kDropOrder:
      job.at_once = false;
      forget_tries(job);
      if (job.state != JobState::kApproved) return;
      job.held = true;
      job.reason = "the order to print it at once is an old one";
      return;
    case JobAction::kFile:
      job.input.clear();
      job.filing_done = true;
      return;
    case JobAction::kNoteDelete:
      job.to_delete = true;
      return;
    case JobAction::kNoteDeleted:
      job.deleted_s = unix_now_s();
      job.to_delete = false;
      return;
    case JobAction::kEnd:
      return end(job);
  }
}

}  // namespace

void forget_tries(JobRecord& job) {
  job.trouble.clear();
  job.trouble_since_s = 0;
  job.tries = 0;
}

bool is_possible(const JobRecord& job, JobEventKind event) {
  return transition_of(state_of(job), event) != nullptr;
}

void JobSteps::apply(JobRecord& job, JobEventKind event) const {
  const std::optional<JobState> from = state_of(job);
  const JobTransition* row = transition_of(from, event);
  if (row == nullptr)
    throw Error(Fault::kInternal,
                "Job " + std::to_string(job.id) + " is " + std::string(state_name(job.state)) +
                    ", which does not know: " + std::string(event_name(event)),
                "Please report this as a bug.");
  job.state = row->to.value_or(job.state);
  act(job, row->action);
  if (listener_) listener_(from, event);
}

}  // namespace packmerger
