// What a job that was prepared waits for, and which print a person's action would start at once.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "daemon/jobs/job_manager.h"

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

// What a person may have said, beyond what is recorded.
struct Supposed {
  bool approved = false;  // the job, and no hold on it
  bool bed_clear = false;
  bool resumed = false;  // its printer
};

// kNothing for jobs in every other state.
Waits waits_for(const JobManager& job_manager, const JobRecord& job, const Supposed& supposed = {});

// The print that one action would start at once; nothing where it starts none now, because
// something else is waited for, or because trays are only handed over.
std::optional<JobRecord> printed_by_approve(const JobManager& job_manager, std::int64_t id);
std::optional<JobRecord> printed_by_again(const JobManager& job_manager,
                                          std::int64_t id);  // with that id
std::optional<JobRecord> printed_by_clear(const JobManager& job_manager,
                                          const std::string& printer);
std::optional<JobRecord> printed_by_resume(const JobManager& job_manager,
                                           const std::string& printer);

}  // namespace packmerger
