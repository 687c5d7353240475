#include "daemon/waits.h"

#include <algorithm>

#include "firmware_io/port.h"

namespace packmerger {
namespace {

bool is_printed_at_once(const Foreman& foreman, const JobRecord& job, const Supposed& supposed) {
  const PrinterConfig* printer = foreman.config().printer(job.printer);
  const bool prints = printer != nullptr && !printer->hands_over();
  return prints && waits_for(foreman, job, supposed) == Waits::kNothing;
}

// In the order in which the foreman starts them: those that failed to start wait a while.
std::optional<JobRecord> first_printed(const Foreman& foreman, const std::string& printer,
                                       const Supposed& supposed) {
  const auto turn = [&](const JobRecord& job) {
    const LiveJob* live = foreman.live(job.id);
    return std::tuple(live != nullptr && live->failures > 0, Foreman::turn_of(job));
  };
  const JobRecord* first = nullptr;
  for (const auto& [id, job] : foreman.store().open_jobs())
    if (job.printer == printer && job.state == JobState::kApproved &&
        is_printed_at_once(foreman, job, supposed) &&
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

Waits waits_for(const Foreman& foreman, const JobRecord& job, const Supposed& supposed) {
  if (job.state != JobState::kReady && job.state != JobState::kApproved) return Waits::kNothing;
  if (job.held && !supposed.approved) return Waits::kHold;
  if (job.state == JobState::kReady && !supposed.approved) return Waits::kApproval;
  const PrinterConfig* printer = foreman.config().printer(job.printer);
  if (printer == nullptr) return Waits::kNoPrinter;
  const PrinterRecord record = foreman.store().printer(job.printer);
  if (record.paused && !supposed.resumed) return Waits::kPaused;
  if (foreman.sending_at(job.printer) != 0) return Waits::kPrinterBusy;
  if (printer->has_bed() && !record.bed_clear && !supposed.bed_clear) return Waits::kClearBed;
  // behind a serial server only another attempt tells
  if (!is_tcp(printer->port) && !foreman.connected(*printer).value_or(true))
    return Waits::kNotConnected;
  return Waits::kNothing;
}

std::optional<JobRecord> printed_by_approve(const Foreman& foreman, std::int64_t id) {
  const std::optional<JobRecord> job = foreman.store().find(id);
  Supposed supposed;
  supposed.approved = true;
  const bool waits = job && (job->state == JobState::kReady || job->state == JobState::kApproved);
  return waits && is_printed_at_once(foreman, *job, supposed) ? job : std::nullopt;
}

std::optional<JobRecord> printed_by_again(const Foreman& foreman, std::int64_t id) {
  const std::optional<JobRecord> old = foreman.store().find(id);
  if (!old || !has_ended(old->state) || !foreman.has_program(*old)) return std::nullopt;
  JobRecord job = foreman.again_of(*old);
  if (foreman.is_approved_by_itself(job)) job.state = JobState::kApproved;
  job.id = id;
  if (job.state != JobState::kApproved || !is_printed_at_once(foreman, job, {}))
    return std::nullopt;
  return job;
}

std::optional<JobRecord> printed_by_clear(const Foreman& foreman, const std::string& printer) {
  Supposed supposed;
  supposed.bed_clear = true;
  return first_printed(foreman, printer, supposed);
}

std::optional<JobRecord> printed_by_resume(const Foreman& foreman, const std::string& printer) {
  Supposed supposed;
  supposed.resumed = true;
  return first_printed(foreman, printer, supposed);
}

}  // namespace packmerger
