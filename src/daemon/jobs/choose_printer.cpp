#include "daemon/jobs/choose_printer.h"

#include <algorithm>
#include <tuple>

#include "base/names.h"
#include "delivery/child_json.h"
#include "job/compare/advice.h"

namespace packmerger {

using nlohmann::json;

void take_estimates(PrinterOffer& offer, const std::string& estimates, const std::string& variant) {
  const std::optional<Comparison> ways = comparison_in(estimates);
  const std::optional<Variant> wanted = variant_named(variant);
  if (!ways || !wanted) {
    offer.why_not = "the comparison tells no figures";
    return;
  }
  const Variant way =
      *wanted == Variant::kCheapest ? cheapest(*ways).value_or(Variant::kPacked) : *wanted;
  offer.variant = variant_name(way);
  const std::optional<Estimate>& figures = estimate_of(*ways, way);
  if (!figures) {
    offer.why_not = printable(why_not(*ways, way));
    return;
  }
  offer.time_s = figures->time_s;
  offer.cost = figures->cost;
  offer.currency = figures->currency;
  offer.parts = figures->parts;
  offer.trays = figures->trays;
}

std::optional<std::size_t> best_offer(const std::vector<PrinterOffer>& offers, Prefer prefer) {
  const auto rank = [&](const PrinterOffer& offer) {
    const bool soonest = prefer == Prefer::kSoonest;
    return std::tuple(!offer.fits(), soonest && !offer.trouble.empty(),
                      soonest ? offer.ready_in_s() : offer.cost,
                      soonest ? offer.cost : offer.ready_in_s());
  };
  const auto best = std::min_element(
      offers.begin(), offers.end(),
      [&](const PrinterOffer& a, const PrinterOffer& b) { return rank(a) < rank(b); });
  if (best == offers.end() || !best->fits()) return std::nullopt;
  return static_cast<std::size_t>(best - offers.begin());
}

json choice_view(const std::vector<PrinterOffer>& offers, Prefer prefer,
                 std::optional<std::size_t> chosen) {
  json printers = json::array();
  for (const PrinterOffer& offer : offers) {
    const auto figure = [&](auto value) { return offer.fits() ? json(value) : json(); };
    printers.push_back({{"printer", offer.printer},
                        {"profile", offer.profile},
                        {"fits", offer.fits()},
                        {"variant", figure(offer.variant)},
                        {"time_s", figure(offer.time_s)},
                        {"cost", figure(offer.cost)},
                        {"currency", figure(offer.currency)},
                        {"parts", figure(offer.parts)},
                        {"trays", figure(offer.trays)},
                        {"waits_s", figure(offer.waits_s)},
                        {"ready_in_s", figure(offer.ready_in_s())},
                        {"trouble", offer.trouble},
                        {"reason", offer.why_not}});
  }
  return {{"prefer", prefer_name(prefer)},
          {"chosen", chosen ? json(offers[*chosen].printer) : json()},
          {"printers", printers}};
}

std::string reasons_of(const std::vector<PrinterOffer>& offers) {
  std::string text;
  for (const PrinterOffer& offer : offers)
    if (!offer.fits()) text += (text.empty() ? "" : "; ") + offer.printer + ": " + offer.why_not;
  return text;
}

std::string_view prefer_name(Prefer prefer) {
  return prefer == Prefer::kSoonest ? "soonest" : "cheapest";
}

}  // namespace packmerger
