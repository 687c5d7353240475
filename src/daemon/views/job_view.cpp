#include "daemon/views/job_view.h"

#include <algorithm>

#include "base/json_values.h"
#include "daemon/intake/beside.h"
#include "daemon/jobs/waits.h"
#include "daemon/settings/model_options.h"
#include "daemon/views/print_view.h"
#include "daemon/views/status_text.h"
#include "daemon/views/trouble_view.h"
#include "delivery/child_json.h"
#include "job/compare/advice.h"
#include "model/estimate.h"
#include "model/files/file_format.h"
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

json passing_view(const JobManager& job_manager, const JobRecord& job) {
  const std::string_view waits = waits_name(waits_for(job_manager, job));
  return {{"same_as", or_null(job_manager.store().same_bytes_before(job))},
          {"waits_for", waits.empty() ? json() : json(waits)},
          {"status", status_text(job_manager, job)},
          {"progress",
           progress_view(job, job_manager.live(job.id), job_manager.config().printer(job.printer))},
          {"correction", correction_view(job_manager.correction(job.printer, job.predicted_by),
                                         job.predicted_by)},
          {"trouble", trouble_view(job_manager.trouble_of(job))},
          {"folder", job.trays > 0 && !job_manager.cleaner().is_gone(job) ? job.folder : ""}};
}

json job_view(const JobManager& job_manager, const JobRecord& job) {
  json view = recorded_view(job);
  view.update(passing_view(job_manager, job));
  return view;
}

json job_view_with_history(const JobManager& job_manager, const JobRecord& job) {
  json view = job_view(job_manager, job);
  view["advice"] = advice_view(job);
  view["history"] = json::array();
  for (const JobEvent& event : job_manager.store().history(job.id))
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
