// Which printers are there.
#include "daemon/jobs/job_manager.h"
#include "delivery/find_port.h"
#include "delivery/way.h"
#include "firmware_io/ports/port.h"

namespace packmerger {

std::optional<bool> JobManager::connected(const PrinterConfig& printer) const {
  if (is_tcp(printer.port)) {
    const auto found = reached_.find(printer.name);
    return found == reached_.end() ? std::nullopt : std::optional(found->second);
  }
  return way_of(printer.abilities).is_connected(printer.port, devices_);
}

// On a port whose name does not stay, once for each that is set: at the start, or by a reload.
void JobManager::advise(const PrinterConfig& printer) {
  if (!looked_ || std::exchange(advised_[printer.name], printer.port) == printer.port) return;
  const std::vector<SerialDevice> none;
  if (const auto advice = advice_on(printer.port, devices_ ? devices_->serial : none))
    log_("warning: printer " + printer.name + ": " + *advice);
}

// A job does not wait for the rest of its time when its printer is back.
void JobManager::notice_printers() {
  for (const PrinterConfig& printer : config_.printers) {
    advise(printer);
    const bool is_there = connected(printer).value_or(true);
    bool& was_there = there_.emplace(printer.name, true).first->second;
    if (std::exchange(was_there, is_there) == is_there) continue;
    log_("printer " + printer.name + (is_there ? ": connected" : ": not connected"));
    if (!is_there) continue;
    for (const auto& [id, job] : store_.open_jobs())
      if (job.printer == printer.name && job.state == JobState::kApproved) {
        live_[id].failures = 0;
        live_[id].retry_s = 0;
      }
  }
}

void JobManager::on(const DevicesSeen& event) {
  devices_ = event.devices;
  if (event.failure) log_(event.failure->what + ". " + event.failure->hint);
  looked_ = true;
  notice_printers();
}

// Whether a printer behind a serial server is on, its last job told.
void JobManager::note_reached(const JobRecord& job, const SendEnded& event) {
  const bool is_busy = event.failure.fault == Fault::kBusy;
  if (event.outcome == SendOutcome::kDone)
    reached_[job.printer] = true;
  else if (event.outcome == SendOutcome::kNotStarted)
    reached_[job.printer] = is_busy;
  else
    reached_.erase(job.printer);
}

}  // namespace packmerger
