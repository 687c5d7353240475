#include "cli/calibration_report.h"

#include <fmt/format.h>

#include <map>
#include <vector>

#include "base/time/duration.h"
#include "cli/daemon_verb.h"
#include "tray/warnings_json.h"

namespace packmerger::cli {
namespace {

using nlohmann::json;

std::string error_text(const CalibratedConstant& constant) {
  if (constant.at_limit) return "at its limit";
  return constant.standard_error ? fmt::format("± {:.2g}", *constant.standard_error) : "not known";
}

void print_constants(const std::vector<CalibratedConstant>& constants) {
  std::vector<std::vector<std::string>> rows = {
      {"CONSTANT", "BEFORE", "FITTED", "ERROR", "UNIT", ""}};
  for (const CalibratedConstant& one : constants)
    rows.push_back({one.key, fmt::format("{:.6g}", one.before),
                    one.fitted ? fmt::format("{:.6g}", one.after) : "-",
                    one.fitted ? error_text(one) : "-", one.unit.empty() ? "-" : one.unit,
                    one.why});
  print_table(rows);
}

std::string amount(const QuantityFit& quantity, double value) {
  return quantity.unit == "s" ? duration_text(value) : fmt::format("{:.1f} g", value);
}

void print_quantity(const QuantityFit& quantity) {
  const auto predicted = [&](double value, double seen) {
    return fmt::format("{} ({:+.1f} %)", amount(quantity, value), 100 * (value / seen - 1));
  };
  std::vector<std::vector<std::string>> rows = {{"PRINT", quantity.unit == "s" ? "TOOK" : "USED",
                                                 "BEFORE", "FITTED", "FITTED TO THE OTHERS"}};
  for (const PrintMisfit& print : quantity.prints)
    rows.push_back({print.print, amount(quantity, print.seen), predicted(print.before, print.seen),
                    predicted(print.after, print.seen),
                    print.left_out ? predicted(*print.left_out, print.seen) : "-"});
  const auto rms = [](double value) { return fmt::format("{:.1f} %", 100 * value); };
  rows.push_back({"root mean square", "", rms(quantity.rms_before), rms(quantity.rms_after),
                  quantity.rms_left_out ? rms(*quantity.rms_left_out) : "-"});
  fmt::print("\n{}\n", quantity.quantity == "time" ? "Time" : quantity.quantity + " material");
  print_table(rows);
}

json or_null(const std::optional<double>& value) { return value ? json(*value) : json(); }

// "2026-03-01, 3 prints, standard error 0.05"
std::string note_of(const CalibratedConstant& constant, const std::string& date) {
  std::string note = constant.unit + (constant.unit.empty() ? "" : "; ");
  note += fmt::format("{}, {} print{}, ", date, constant.prints, constant.prints == 1 ? "" : "s");
  if (constant.at_limit) return note + "at a limit of its range";
  if (!constant.standard_error) return note + "standard error not known: no print left over";
  return note + fmt::format("standard error {:.2g}", *constant.standard_error);
}

}  // namespace

void print_calibration(const Calibration& calibration) {
  print_constants(calibration.constants);
  for (const QuantityFit& quantity : calibration.quantities) print_quantity(quantity);
}

json calibration_json(const Calibration& calibration) {
  json told = {{"profile", calibration.profile.id},
               {"constants", json::array()},
               {"quantities", json::object()},
               {"warnings", json::array()}};
  for (const CalibratedConstant& one : calibration.constants)
    told["constants"].push_back({{"key", one.key},
                                 {"unit", one.unit},
                                 {"before", one.before},
                                 {"after", one.after},
                                 {"fitted", one.fitted},
                                 {"at_limit", one.at_limit},
                                 {"prints", one.prints},
                                 {"standard_error", or_null(one.standard_error)},
                                 {"why", one.why}});
  for (const QuantityFit& quantity : calibration.quantities) {
    json& fit = told["quantities"][quantity.quantity];
    fit = {{"unit", quantity.unit},
           {"rms_before", quantity.rms_before},
           {"rms_after", quantity.rms_after},
           {"rms_left_out", or_null(quantity.rms_left_out)},
           {"prints", json::array()}};
    for (const PrintMisfit& print : quantity.prints)
      fit["prints"].push_back({{"print", print.print},
                               {"seen", print.seen},
                               {"before", print.before},
                               {"after", print.after},
                               {"left_out", or_null(print.left_out)}});
  }
  told["warnings"] = warnings_json(calibration.warnings);
  return told;
}

std::string calibrated_toml(const Calibration& calibration, const std::optional<ProfileBase>& base,
                            std::size_t prints, const std::string& date, const std::string& id) {
  std::map<std::string, std::string> notes;
  std::string names;
  for (const CalibratedConstant& one : calibration.constants) {
    if (!one.fitted) continue;
    notes[one.key] = note_of(one, date);
    names += (names.empty() ? "" : ", ") + one.key;
  }
  std::string text =
      fmt::format("# Fitted to {} finished print{} on {} by packmerger calibrate: {}\n", prints,
                  prints == 1 ? "" : "s", date, names);
  if (base) return text + derived_profile_toml(calibration.profile, *base, notes);
  Profile whole = calibration.profile;
  whole.id = id;
  return text + profile_toml(whole);
}

}  // namespace packmerger::cli
