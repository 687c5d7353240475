#include "daemon/views/status_text.h"

#include <fmt/format.h>

#include "base/time/duration.h"
#include "daemon/jobs/waits.h"
#include "daemon/views/print_view.h"

namespace packmerger {
namespace {

std::string waiting_text(Waits waits) {
  switch (waits) {
    case Waits::kApproval:
      return "waits for approval";
    case Waits::kHold:
      return "held";
    case Waits::kNoPrinter:
      return "its printer is not configured any more";
    case Waits::kPaused:
      return "waits: the printer is paused";
    case Waits::kPrinterBusy:
      return "waits for the printer";
    case Waits::kClearBed:
      return "waits for a clear bed";
    case Waits::kNotConnected:
      return "waits: the printer is not connected";
    case Waits::kNothing:
      return "waits to be sent";
  }
  return {};
}

// Why it could not be begun so far.
std::string tries_text(const JobRecord& job) {
  if (job.tries == 0) return job.reason;
  return job.trouble + (job.tries == 1 ? "" : fmt::format(", tried {} times", job.tries));
}

std::string in_brackets(const std::string& text) { return text.empty() ? "" : " (" + text + ")"; }

std::string sending_text(const JobRecord& job, const LiveJob* live) {
  if (live == nullptr) return "sending";
  const std::string tray =
      job.trays > 1 ? fmt::format("tray {} of {}, ", job.next_tray, job.trays) : "";
  const std::string_view state = print_state_name(live->print.state);
  std::string text = fmt::format("{}{} {:.0f} %", tray, state, 100 * fraction_of(live->print));
  if (!live->print.text.empty() && live->print.text != state) text += ", " + live->print.text;
  if (live->print.remaining_s && live->print.done > 0)
    text += ", " + duration_text(*live->print.remaining_s) + " left";
  return JobManager::is_tried_again(job) ? text + in_brackets(tries_text(job)) : text;
}

std::string state_text(const JobManager& job_manager, const JobRecord& job, const LiveJob* live) {
  switch (job.state) {
    case JobState::kClaiming:
      return "being taken";
    case JobState::kReceived:
      return "waits to be prepared";
    case JobState::kPreparing:
      if (live == nullptr || live->stage.empty()) return "preparing";
      return fmt::format("{} {:.0f} %", live->stage, 100 * live->fraction);
    case JobState::kReady:
    case JobState::kApproved:
      return waiting_text(waits_for(job_manager, job)) + in_brackets(tries_text(job));
    case JobState::kSending:
      return sending_text(job, live);
    case JobState::kHandedOver:
      return "handed over: open it in the printer's own software";
    case JobState::kDone:
      return "printed";
    case JobState::kFailed:
    case JobState::kCancelled:
      return job.reason;
  }
  return {};
}

}  // namespace

std::string status_text(const JobManager& job_manager, const JobRecord& job) {
  const LiveJob* live = job_manager.live(job.id);
  const std::string text = state_text(job_manager, job, live);
  return live == nullptr ? text : text + in_brackets(live->trouble);
}

}  // namespace packmerger
