#include "daemon/jobs/job_refusals.h"

#include "base/error.h"

namespace packmerger {
namespace {

struct Refusal {
  JobEventKind event;
  bool has_ended;    // of which jobs it speaks
  const char* what;  // behind "Job 12 is sending"
  const char* hint;
};

constexpr Refusal kRefusals[] = {
    {JobEventKind::kApprove, false, " and does not wait for approval",
     "packmerger jobs show tells what it waits for."},
    {JobEventKind::kApprove, true, " and does not wait for approval",
     "packmerger jobs show tells what it waits for."},
    {JobEventKind::kHold, false, " and cannot be held",
     "Cancel it with packmerger jobs cancel instead."},
    {JobEventKind::kHold, true, "", "There is nothing to hold any more."},
    {JobEventKind::kPutFirst, false, "", "It waits for nothing any more."},
    {JobEventKind::kPutFirst, true, "", "packmerger jobs again has it printed once more."},
    {JobEventKind::kPrepareOtherwise, false, " and cannot be prepared in another way now",
     "Wait until it is ready, or cancel it and prepare it again."},
    {JobEventKind::kCancel, true, "", "There is nothing to cancel any more."},
    {JobEventKind::kFileAgain, false, " and has not ended",
     "Wait for its end, or cancel it first."},
};

}  // namespace

std::string title_of(const JobRecord& job) { return "Job " + std::to_string(job.id); }

void refuse(const JobRecord& job, JobEventKind event) {
  if (event == JobEventKind::kCancel && job.state == JobState::kClaiming)
    throw Error(Fault::kBusy, title_of(job) + " is just being taken", "Try again in a moment.");
  if (event == JobEventKind::kDelete)
    throw Error(Fault::kUsage, title_of(job) + " has not ended", "Cancel it first.");
  for (const Refusal& refusal : kRefusals)
    if (refusal.event == event && refusal.has_ended == has_ended(job.state))
      throw Error(Fault::kUsage,
                  title_of(job) + " is " + std::string(state_name(job.state)) + refusal.what,
                  refusal.hint);
  throw Error(Fault::kInternal,
              title_of(job) + " is " + std::string(state_name(job.state)) +
                  ", which refuses: " + std::string(event_name(event)),
              "Please report this as a bug.");
}

}  // namespace packmerger
