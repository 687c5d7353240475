#include "daemon/printer_view.h"

#include "daemon/json_values.h"
#include "daemon/print_view.h"
#include "daemon/trouble_view.h"
#include "model/estimate.h"

namespace packmerger {
namespace {

using nlohmann::json;

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

}  // namespace

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
          {"print", print_view(foreman.live(sending), &printer)}};
}

}  // namespace packmerger
