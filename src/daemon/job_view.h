// Jobs and printers as people and programs are shown them.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "daemon/config.h"
#include "daemon/foreman.h"
#include "job/job_store.h"

namespace packmerger {

// Why a job that is ready or approved is not being sent.
enum class Waits {
  kNothing,
  kApproval,
  kHold,
  kNoPrinter,  // its printer is not configured any more
  kPaused,
  kPrinterBusy,
  kClearBed,
  kNotConnected,  // its port does not exist now
};
// "", "approval", "hold", "no_printer", "paused", "printer_busy", "clear_bed", "not_connected".
std::string_view waits_name(Waits waits);

// kNothing for jobs in every other state.
Waits waits_for(const Foreman& foreman, const JobRecord& job);

// What `jobs list` shows, and with history what `jobs show` does; docs/DAEMON.md names the keys.
nlohmann::json job_view(const Foreman& foreman, const JobRecord& job);
nlohmann::json job_view_with_history(const Foreman& foreman, const JobRecord& job);
nlohmann::json printer_view(const Foreman& foreman, const PrinterConfig& printer);

// What the daemon does, in a line: "2 printers; preparing job 5; job 4 is at lab".
std::string daemon_status(const Foreman& foreman);

// The notes beside a filed model.
std::string result_note(const JobRecord& job);  // JSON
std::string reason_note(const JobRecord& job);  // for people

}  // namespace packmerger
