#include "daemon/views/printer_view.h"

#include "base/json_values.h"
#include "daemon/views/print_view.h"
#include "daemon/views/trouble_view.h"
#include "model/estimate.h"

namespace packmerger {
namespace {

using nlohmann::json;

json corrections_view(const JobManager& job_manager, const PrinterConfig& printer) {
  json corrections = json::array();
  for (const EstimateSource source : {EstimateSource::kSlicer, EstimateSource::kModel,
                                      EstimateSource::kProgram, EstimateSource::kMoves}) {
    const std::string name(source_name(source));
    const json view = correction_view(job_manager.correction(printer.name, name), name);
    if (!view.is_null()) corrections.push_back(view);
  }
  return corrections;
}

}  // namespace

json printer_view(const JobManager& job_manager, const PrinterConfig& printer) {
  const PrinterRecord record = job_manager.store().printer(printer.name);
  const std::int64_t sending = job_manager.sending_at(printer.name);
  const std::optional<bool> connected = job_manager.connected(printer);
  const Troubles troubles = job_manager.troubles_at(printer);
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
          {"corrections", corrections_view(job_manager, printer)},
          {"job", sending == 0 ? json() : json(sending)},
          {"print", print_view(job_manager.live(sending), &printer)}};
}

}  // namespace packmerger
