#include "daemon/choose_printer.h"

#include <algorithm>
#include <array>
#include <tuple>

namespace packmerger {
namespace {

using nlohmann::json;

constexpr std::array<const char*, 3> kWays = {"solid", "hollow", "packed"};

// Nothing where that way does not fit, or its figures are missing.
const json* figures_of(const json& ways, const std::string& way) {
  const auto found = ways.find(way);
  if (found == ways.end() || !found->is_object()) return nullptr;
  for (const char* key : {"time_s", "cost"})
    if (!found->contains(key) || !found->at(key).is_number()) return nullptr;
  return &*found;
}

std::string cheapest_way(const json& ways) {
  std::string best = "packed";
  for (const char* way : kWays) {
    const json* one = figures_of(ways, way);
    const json* other = figures_of(ways, best);
    if (one != nullptr && (other == nullptr || one->at("cost") < other->at("cost"))) best = way;
  }
  return best;
}

}  // namespace

void take_estimates(PrinterOffer& offer, const std::string& estimates, const std::string& variant) {
  const json ways = json::parse(estimates, nullptr, false);
  if (!ways.is_object()) {
    offer.why_not = "the comparison tells no figures";
    return;
  }
  offer.variant = variant == "cheapest" ? cheapest_way(ways) : variant;
  const json* figures = figures_of(ways, offer.variant);
  if (figures == nullptr) {
    offer.why_not = "it does not fit, " + offer.variant;
    return;
  }
  offer.time_s = figures->at("time_s");
  offer.cost = figures->at("cost");
  offer.currency = figures->value("currency", "");
  offer.parts = figures->value("parts", 1);
  offer.trays = figures->value("trays", 1);
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
