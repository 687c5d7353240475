#include "daemon/jobs/waits.h"

#include <algorithm>

#include "firmware_io/ports/port.h"

namespace packmerger {
namespace {

bool is_printed_at_once(const JobManager& job_manager, const JobRecord& job,
                        const Supposed& supposed) {
  const PrinterConfig* printer = job_manager.config().printer(job.printer);
  const bool prints = printer != nullptr && !printer->hands_over();
  return prints && waits_for(job_manager, job, supposed) == Waits::kNothing;
}

// In the order in which the job manager starts them: those that failed to start wait a while.
std::optional<JobRecord> first_printed(const JobManager& job_manager, const std::string& printer,
                                       const Supposed& supposed) {
  const auto turn = [&](const JobRecord& job) {
    const LiveJob* live = job_manager.live(job.id);
    return std::tuple(live != nullptr && live->failures > 0, JobManager::turn_of(job));
  };
  const JobRecord* first = nullptr;
  for (const auto& [id, job] : job_manager.store().open_jobs())
    if (job.printer == printer && job.state == JobState::kApproved &&
        is_printed_at_once(job_manager, job, supposed) &&
        (first == nullptr || turn(job) < turn(*first)))
      first = &job;
  return first == nullptr ? std::nullopt : std::optional(*first);
}

}  // namespace

std::string_view waits_name(Waits waits) {
  switch (waits) {
    case Waits::kNothing:
      return "";
    case Waits::kApproval:
      return "approval";
    case Waits::kHold:
      return "hold";
    case Waits::kNoPrinter:
      return "no_printer";
    case Waits::kPaused:
      return "paused";
    case Waits::kPrinterBusy:
      return "printer_busy";
    case Waits::kClearBed:
      return "clear_bed";
    case Waits::kNotConnected:
      return "not_connected";
  }
  return "";
}

Waits waits_for(const JobManager& job_manager, const JobRecord& job, const Supposed& supposed) {
  if (job.state != JobState::kReady && job.state != JobState::kApproved) return Waits::kNothing;
  if (job.held && !supposed.approved) return Waits::kHold;
  if (job.state == JobState::kReady && !supposed.approved) return Waits::kApproval;
  const PrinterConfig* printer = job_manager.config().printer(job.printer);
  if (printer == nullptr) return Waits::kNoPrinter;
  const PrinterRecord record = job_manager.store().printer(job.printer);
  if (record.paused && !supposed.resumed) return Waits::kPaused;
  if (job_manager.sending_at(job.printer) != 0) return Waits::kPrinterBusy;
  if (printer->has_bed() && !record.bed_clear && !supposed.bed_clear) return Waits::kClearBed;
  // behind a serial server only another attempt tells
  if (!is_tcp(printer->port) && !job_manager.connected(*printer).value_or(true))
    return Waits::kNotConnected;
  return Waits::kNothing;
}

std::optional<JobRecord> printed_by_approve(const JobManager& job_manager, std::int64_t id) {
  const std::optional<JobRecord> job = job_manager.store().find(id);
  Supposed supposed;
  supposed.approved = true;
  const bool waits = job && (job->state == JobState::kReady || job->state == JobState::kApproved);
  return waits && is_printed_at_once(job_manager, *job, supposed) ? job : std::nullopt;
}

std::optional<JobRecord> printed_by_again(const JobManager& job_manager, std::int64_t id) {
  const std::optional<JobRecord> old = job_manager.store().find(id);
  if (!old || !has_ended(old->state) || !job_manager.has_program(*old)) return std::nullopt;
  JobRecord job = job_manager.again_of(*old);
  if (job_manager.is_approved_by_itself(job)) job.state = JobState::kApproved;
  job.id = id;
  if (job.state != JobState::kApproved || !is_printed_at_once(job_manager, job, {}))
    return std::nullopt;
  return job;
}

std::optional<JobRecord> printed_by_clear(const JobManager& job_manager,
                                          const std::string& printer) {
  Supposed supposed;
  supposed.bed_clear = true;
  return first_printed(job_manager, printer, supposed);
}

std::optional<JobRecord> printed_by_resume(const JobManager& job_manager,
                                           const std::string& printer) {
  Supposed supposed;
  supposed.resumed = true;
  return first_printed(job_manager, printer, supposed);
}

}  // namespace packmerger
