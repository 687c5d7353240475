#include "daemon/job_view.h"

#include <algorithm>

#include "daemon/child_json.h"
#include "daemon/job_file.h"
#include "daemon/json_values.h"
#include "daemon/model_options.h"
#include "daemon/move_file.h"
#include "daemon/print_view.h"
#include "daemon/status_text.h"
#include "daemon/trouble_view.h"
#include "daemon/waits.h"
#include "job/advice.h"
#include "model/estimate.h"
#include "tray/comparison_json.h"

namespace packmerger {
namespace {

using nlohmann::json;

json progress_view(const JobRecord& job, const LiveJob* live, const PrinterConfig* printer) {
  if (live == nullptr) return nullptr;
  if (job.state == JobState::kPreparing)
    return {{"stage", live->stage}, {"fraction", live->fraction}};
  return job.state == JobState::kSending ? print_view(live, printer) : json();
}

// Which way of printing its model is best; null where they were not compared.
json advice_view(const JobRecord& job) {
  const std::optional<Comparison> ways = comparison_in(job.estimates);
  if (!ways || is_program(job.name)) return nullptr;
  const Advice told = advice(*ways);
  return advice_json(told.variant ? variant_name(*told.variant) : "", told.text);
}

std::string_view kind_name(const JobRecord& job) {
  return is_program(job.name) ? "program" : "model";
}

}  // namespace

json recorded_view(const JobRecord& job) {
  return {
      {"id", job.id},
      {"printer", job.printer},
      {"chosen_by", or_null(job.chosen_by)},
      {"choice", object_or_null(job.choice)},
      {"name", job.name},
      {"kind", kind_name(job)},
      {"sha256", job.sha256},
      {"state", state_name(job.state)},
      {"held", job.held},
      {"turn", job.turn},
      {"trays", job.trays},
      {"tray", job.next_tray},
      {"settings", job.with_settings ? json(settings_beside(job.name).string()) : json()},
      {"profile", or_null(job.profile)},
      {"seed", job.profile.empty() || is_program(job.name) ? json() : json(job.seed)},
      {"variant", job.variant},
      {"tray_files", list_or_null(job.tray_files)},
      {"pays", job.pays},
      {"doubt", or_null(job.doubt)},
      {"approved", job.approved},
      {"estimates", object_or_null(job.estimates)},
      {"predicted_s", or_null(job.predicted_s)},
      {"printed_s", or_null(job.printed_s)},
      {"paused_s", or_null(job.paused_s)},
      {"reason", job.reason},
      {"hint", job.hint},
      {"told", job.told_total == 0 ? json() : json{{"done", job.told}, {"total", job.told_total}}},
      {"deleted_s", or_null(job.deleted_s)},
      {"filed", job.filing_done ? job.filed : ""},
      {"again_of", or_null(job.again_of)},
      {"received_s", or_null(job.received_s)},
      {"sending_s", or_null(job.sending_s)},
      {"ended_s", or_null(job.ended_s)}};
}

json passing_view(const Foreman& foreman, const JobRecord& job) {
  const std::string_view waits = waits_name(waits_for(foreman, job));
  return {
      {"same_as", or_null(foreman.store().same_bytes_before(job))},
      {"waits_for", waits.empty() ? json() : json(waits)},
      {"status", status_text(foreman, job)},
      {"progress", progress_view(job, foreman.live(job.id), foreman.config().printer(job.printer))},
      {"correction",
       correction_view(foreman.correction(job.printer, job.predicted_by), job.predicted_by)},
      {"trouble", trouble_view(foreman.trouble_of(job))},
      {"folder", job.trays > 0 && !foreman.cleaner().is_gone(job) ? job.folder : ""}};
}

json job_view(const Foreman& foreman, const JobRecord& job) {
  json view = recorded_view(job);
  view.update(passing_view(foreman, job));
  return view;
}

json job_view_with_history(const Foreman& foreman, const JobRecord& job) {
  json view = job_view(foreman, job);
  view["advice"] = advice_view(job);
  view["history"] = json::array();
  for (const JobEvent& event : foreman.store().history(job.id))
    view["history"].push_back(
        {{"at_s", event.at_s}, {"state", state_name(event.state)}, {"note", event.note}});
  return view;
}

json start_view(const JobRecord& job) {
  return {{"job", job.id},
          {"name", job.name},
          {"printer", job.printer},
          {"tray", job.next_tray},
          {"trays", job.trays},
          {"time_s", or_null(std::max(0.0, job.predicted_s - job.printed_s))},
          {"doubt", or_null(job.doubt)}};
}

}  // namespace packmerger
