#include "daemon/views/print_view.h"

namespace packmerger {
namespace {

using nlohmann::json;

json heaters_view(const PrintReport& print) {
  json heaters = json::array();
  for (const HeaterReport& heater : print.heaters)
    heaters.push_back({{"name", heater.name},
                       {"actual_c", heater.actual_c},
                       {"target_c", heater.target_c ? json(*heater.target_c) : json()}});
  return heaters;
}

}  // namespace

double fraction_of(const PrintReport& report) {
  return report.total == 0 ? 0
                           : static_cast<double>(report.done) / static_cast<double>(report.total);
}

json print_view(const LiveJob* live, const PrinterConfig* printer) {
  if (live == nullptr || !live->control) return nullptr;
  return {{"stage", print_state_name(live->print.state)},
          {"fraction", fraction_of(live->print)},
          {"done", live->print.done},
          {"total", live->print.total},
          {"unit", printer == nullptr ? "byte" : way_of(printer->abilities).unit},
          {"text", live->print.text},
          {"choices", live->print.choices},
          {"heaters", heaters_view(live->print)},
          {"elapsed_s", live->print.elapsed_s},
          {"remaining_s", live->print.remaining_s ? json(*live->print.remaining_s) : json()}};
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

}  // namespace packmerger
