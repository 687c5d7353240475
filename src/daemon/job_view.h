// Jobs and printers as people and programs are shown them.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "daemon/config.h"
#include "daemon/foreman.h"
#include "job/job_store.h"

namespace packmerger {

// What `jobs list` shows, and with history what `jobs show` does; docs/DAEMON.md names the keys.
nlohmann::json job_view(const Foreman& foreman, const JobRecord& job);
// Its two halves: what the record alone tells, and what also changes while the record stays.
nlohmann::json recorded_view(const JobRecord& job);
nlohmann::json passing_view(const Foreman& foreman, const JobRecord& job);
nlohmann::json job_view_with_history(const Foreman& foreman, const JobRecord& job);
nlohmann::json printer_view(const Foreman& foreman, const PrinterConfig& printer);
// The disk of the state folder, and which jobs' folders are deleted.
nlohmann::json storage_view(const Foreman& foreman);
// What fails again and again, but for that of jobs and printers; docs/DAEMON.md names the keys.
nlohmann::json troubles_view(const Foreman& foreman);
// A print that an action starts at once; docs/DAEMON.md names the keys.
nlohmann::json start_view(const JobRecord& job);

// What the daemon does, in a line: "2 printers; preparing job 5; job 4 is at lab".
std::string daemon_status(const Foreman& foreman);

// The notes beside a filed model.
std::string result_note(const JobRecord& job);  // JSON
std::string reason_note(const JobRecord& job);  // for people

}  // namespace packmerger
