#include "daemon/job_view.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/duration.h"
#include "daemon/child_json.h"
#include "daemon/job_file.h"
#include "daemon/json_values.h"
#include "daemon/model_options.h"
#include "daemon/move_file.h"
#include "daemon/trouble_view.h"
#include "daemon/waits.h"
#include "job/advice.h"
#include "model/estimate.h"
#include "tray/comparison_json.h"

namespace packmerger {
namespace {

using nlohmann::json;

double fraction_of(const PrintReport& report) {
  return report.total == 0 ? 0
                           : static_cast<double>(report.done) / static_cast<double>(report.total);
}

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
  return Foreman::is_tried_again(job) ? text + in_brackets(tries_text(job)) : text;
}

std::string state_text(const Foreman& foreman, const JobRecord& job, const LiveJob* live) {
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
      return waiting_text(waits_for(foreman, job)) + in_brackets(tries_text(job));
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

// One short phrase for people: what the job does or waits for, and what is wrong with its file.
std::string status_text(const Foreman& foreman, const JobRecord& job) {
  const LiveJob* live = foreman.live(job.id);
  const std::string text = state_text(foreman, job, live);
  return live == nullptr ? text : text + in_brackets(live->trouble);
}

json heaters_view(const PrintReport& print) {
  json heaters = json::array();
  for (const HeaterReport& heater : print.heaters)
    heaters.push_back({{"name", heater.name},
                       {"actual_c", heater.actual_c},
                       {"target_c", heater.target_c ? json(*heater.target_c) : json()}});
  return heaters;
}

json print_view(const LiveJob* live, std::string_view unit) {
  if (live == nullptr || !live->control) return nullptr;
  return {{"stage", print_state_name(live->print.state)},
          {"fraction", fraction_of(live->print)},
          {"done", live->print.done},
          {"total", live->print.total},
          {"unit", unit},
          {"text", live->print.text},
          {"choices", live->print.choices},
          {"heaters", heaters_view(live->print)},
          {"elapsed_s", live->print.elapsed_s},
          {"remaining_s", live->print.remaining_s ? json(*live->print.remaining_s) : json()}};
}

// What its progress is counted in.
std::string_view unit_of(const PrinterConfig* printer) {
  return printer != nullptr && printer->abilities.dialect == Dialect::kGcode ? "line" : "byte";
}

json progress_view(const JobRecord& job, const LiveJob* live, std::string_view unit) {
  if (live == nullptr) return nullptr;
  if (job.state == JobState::kPreparing)
    return {{"stage", live->stage}, {"fraction", live->fraction}};
  return job.state == JobState::kSending ? print_view(live, unit) : json();
}

json correction_view(const std::optional<Correction>& correction, const std::string& source) {
  if (!correction) return nullptr;
  return {{"source", source},
          {"factor", correction->factor},
          {"low", correction->low},
          {"high", correction->high},
          {"prints", correction->prints},
          {"left_out", correction->left_out}};
}

json corrections_view(const Foreman& foreman, const PrinterConfig& printer) {
  json corrections = json::array();
  for (const EstimateSource source : {EstimateSource::kSlicer, EstimateSource::kModel,
                                      EstimateSource::kProgram, EstimateSource::kMoves}) {
    const std::string name(source_name(source));
    const json view = correction_view(foreman.correction(printer.name, name), name);
    if (!view.is_null()) corrections.push_back(view);
  }
  return corrections;
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
  return {{"same_as", or_null(foreman.store().same_bytes_before(job))},
          {"waits_for", waits.empty() ? json() : json(waits)},
          {"status", status_text(foreman, job)},
          {"progress", progress_view(job, foreman.live(job.id),
                                     unit_of(foreman.config().printer(job.printer)))},
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

json printer_view(const Foreman& foreman, const PrinterConfig& printer) {
  const PrinterRecord record = foreman.store().printer(printer.name);
  const std::int64_t sending = foreman.sending_at(printer.name);
  const std::optional<bool> connected = foreman.connected(printer);
  const Troubles troubles = foreman.troubles_at(printer);
  std::string bed = record.bed_clear ? "clear" : "not clear";
  if (!printer.has_bed()) bed = "none";
  return {{"name", printer.name},
          {"profile", printer.is_auto() ? printer.profile : printer.abilities.id},
          {"prefer", printer.prefer ? json(prefer_name(*printer.prefer)) : json()},
          {"folder", printer.folder.string()},
          {"port", printer.port},
          {"handoff_folder", printer.handoff_folder.string()},
          {"approve", printer.approve == Approve::kAuto ? "auto" : "ask"},
          {"simulated", printer.simulated},
          {"connected", connected ? json(*connected) : json()},
          {"bed", bed},
          {"paused", record.paused},
          {"trouble", or_null(words_of(troubles))},
          {"troubles", list_of(troubles)},
          {"corrections", corrections_view(foreman, printer)},
          {"job", sending == 0 ? json() : json(sending)},
          {"print", print_view(foreman.live(sending), unit_of(&printer))}};
}

json storage_view(const Foreman& foreman) {
  const std::optional<Room>& room = foreman.cleaner().room();
  const std::optional<Announced>& announced = foreman.cleaner().announced();
  const bool announces = announced && announced->jobs > 0;
  return {{"free_bytes", room ? json(room->free_bytes) : json()},
          {"low", room && room->is_low()},
          {"keep_days", foreman.config().keep_days},
          {"keep_jobs", foreman.config().keep_jobs},
          {"announced",
           announces ? json{{"from_s", announced->from_s}, {"jobs", announced->jobs}} : json()}};
}

json troubles_view(const Foreman& foreman) { return list_of(foreman.troubles()); }

json start_view(const JobRecord& job) {
  return {{"job", job.id},
          {"name", job.name},
          {"printer", job.printer},
          {"tray", job.next_tray},
          {"trays", job.trays},
          {"time_s", or_null(std::max(0.0, job.predicted_s - job.printed_s))},
          {"doubt", or_null(job.doubt)}};
}

std::string daemon_status(const Foreman& foreman) {
  const std::vector<PrinterConfig>& printers = foreman.config().printers;
  const auto count = std::count_if(printers.begin(), printers.end(),
                                   [](const PrinterConfig& printer) { return !printer.is_auto(); });
  std::string text = count == 0 ? "no printer is configured"
                                : fmt::format("{} printer{}", count, count > 1 ? "s" : "");
  for (const auto& [job, preparer] : foreman.preparing())
    text += fmt::format("; preparing job {}", job);
  for (const PrinterConfig& printer : printers)
    if (const std::int64_t job = foreman.sending_at(printer.name); job != 0)
      text += fmt::format("; job {} is at {}", job, printer.name);
  for (const auto& [about, trouble] : foreman.troubles()) text += "; trouble with: " + about;
  if (const std::optional<Room>& room = foreman.cleaner().room(); room && room->is_low())
    text += fmt::format("; only {:.1f} GiB free",
                        static_cast<double>(room->free_bytes) / (std::uint64_t{1} << 30));
  return text;
}

}  // namespace packmerger
