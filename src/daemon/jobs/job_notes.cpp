#include "daemon/jobs/job_notes.h"

#include <fmt/format.h>

#include "base/json_values.h"
#include "base/names.h"

namespace packmerger {

using nlohmann::json;

std::string result_note(const JobRecord& job) {
  const json note = {{"job", job.id},
                     {"printer", job.printer},
                     {"state", state_name(job.state)},
                     {"name", job.name},
                     {"sha256", job.sha256},
                     {"folder", job.folder},
                     {"trays", job.trays},
                     {"profile", job.profile},
                     {"seed", job.seed},
                     {"variant", job.variant},
                     {"tray_files", list_or_null(job.tray_files)},
                     {"estimates", object_or_null(job.estimates)},
                     {"choice", object_or_null(job.choice)},
                     {"predicted_s", or_null(job.predicted_s)},
                     {"printed_s", or_null(job.printed_s)},
                     {"paused_s", or_null(job.paused_s)},
                     {"received_s", or_null(job.received_s)},
                     {"sending_s", or_null(job.sending_s)},
                     {"ended_s", or_null(job.ended_s)}};
  return note.dump(2, ' ', false, json::error_handler_t::replace) + "\n";
}

std::string reason_note(const JobRecord& job) {
  return fmt::format("{}: {}\n{}{}job {} on {}\n", printable(job.name),
                     job.reason.empty() ? std::string(state_name(job.state)) : job.reason, job.hint,
                     job.hint.empty() ? "" : "\n", job.id, job.printer);
}

}  // namespace packmerger
