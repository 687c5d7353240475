// Choosing one of several printers for a model: what each would take, and when it could be ready.
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "daemon/settings/config.h"

namespace packmerger {

// What a printer would take for the model, by the way of printing it that would be prepared for it.
struct PrinterOffer {
  std::string printer;
  std::string profile;
  std::string variant;  // packed, hollow or solid
  double time_s = 0;
  double cost = 0;
  std::string currency;
  int parts = 1;
  int trays = 1;
  double waits_s = 0;   // for what is printed and queued there before it
  std::string trouble;  // why it could not start now: paused, not connected; empty: nothing
  std::string why_not;  // why it cannot be printed there; then nothing above counts but the names

  bool fits() const { return why_not.empty(); }
  double ready_in_s() const { return waits_s + time_s; }
};

// Takes time, cost, parts and trays from `estimates` (job.json's, as text): of `variant`, where
// that is "cheapest" of the cheapest of solid, hollow and packed. Where it does not fit
// or cannot be made, why_not says so.
void take_estimates(PrinterOffer& offer, const std::string& estimates, const std::string& variant);

// The index of the cheapest, or of the one that is ready soonest; then printers that cannot start
// now come last. Ties go to the other measure, then to the first. Nothing where none fits.
std::optional<std::size_t> best_offer(const std::vector<PrinterOffer>& offers, Prefer prefer);

// {"prefer", "chosen", "printers": [{"printer", "profile", "fits", "variant", "time_s", "cost",
// "currency", "parts", "trays", "waits_s", "ready_in_s", "trouble", "reason"}]}; figures are null
// where it does not fit.
nlohmann::json choice_view(const std::vector<PrinterOffer>& offers, Prefer prefer,
                           std::optional<std::size_t> chosen);

// "replicator: it does not fit; marlin: …"
std::string reasons_of(const std::vector<PrinterOffer>& offers);

std::string_view prefer_name(Prefer prefer);  // "cheapest", "soonest"

}  // namespace packmerger
