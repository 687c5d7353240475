#include "job/compare/advice.h"

#include <fmt/format.h>

#include <array>
#include <utility>

namespace packmerger {
namespace {

constexpr std::array<std::pair<Variant, std::string_view>, 4> kNames = {
    std::pair{Variant::kPacked, "packed"},
    {Variant::kHollow, "hollow"},
    {Variant::kSolid, "solid"},
    {Variant::kCheapest, "cheapest"}};

// Less than this share of the cost is not worth gluing for.
constexpr double kLittleGain = 0.02;

std::optional<Variant> cheapest_piece(const Comparison& comparison) {
  const std::optional<Estimate>& solid = comparison.solid;
  const std::optional<Estimate>& hollow = comparison.hollow;
  if (!solid && !hollow) return std::nullopt;
  const bool is_solid = solid && (!hollow || solid->cost <= hollow->cost);
  return is_solid ? Variant::kSolid : Variant::kHollow;
}

bool is_hours_unpriced(const Estimate& way) {
  return way.material_cost > 0 && way.machine_cost == 0;
}

bool takes_longer(const Estimate& packed, const Estimate& other) {
  return packed.time_s > other.time_s;
}

// Where the profile has no price for the machine's hours, material is not saved at their expense.
bool pays(const Estimate& packed, const Estimate& other) {
  return packed.cost < other.cost && !(is_hours_unpriced(other) && takes_longer(packed, other));
}

std::string per_cent(double value, double other, const char* of_what) {
  if (other <= 0) return "";
  return fmt::format("{:+.0f} % {}", 100 * (value / other - 1), of_what);
}

std::string longer(double time_s, double other_s) {
  return other_s > 0 ? fmt::format("{:.0f} % longer", 100 * (time_s / other_s - 1)) : "longer";
}

std::string changes(const Estimate& packed, const Estimate& other) {
  const std::string time = per_cent(packed.time_s, other.time_s, "time");
  const std::string cost = per_cent(packed.cost, other.cost, "cost");
  std::string text = time + (time.empty() || cost.empty() ? "" : ", ") + cost;
  const double more_min = packed.assembly_min - other.assembly_min;
  if (more_min >= 0.5) text += fmt::format(", {:+.0f} min by hand", more_min);
  return text;
}

std::string for_packing(const Estimate& packed, const Estimate& other, const std::string& name) {
  const bool little = packed.cost > (1 - kLittleGain) * other.cost;
  return fmt::format("{}: {:.2f} {} less than printing it {}, in one piece ({}).",
                     little ? "Little is to be gained by packing" : "Pack it",
                     other.cost - packed.cost, packed.currency, name, changes(packed, other));
}

std::string against_packing(const Estimate& packed, const Estimate& other,
                            const std::string& name) {
  if (packed.cost < other.cost)
    return fmt::format(
        "Packing does not pay here: it saves {:.2f} {}, but takes {} than printing it {}, in one "
        "piece.",
        other.cost - packed.cost, packed.currency, longer(packed.time_s, other.time_s), name);
  const double more = packed.cost - other.cost;
  const std::string costs =
      more < kSameCost ? "as little" : fmt::format("{:.2f} {} less", more, packed.currency);
  return fmt::format("{}: printing it {}, in one piece, costs {}.",
                     packed.parts == 1 ? "There is nothing to pack" : "Packing does not pay here",
                     name, costs);
}

}  // namespace

std::vector<std::string> variant_names() {
  std::vector<std::string> names;
  for (const auto& known : kNames) names.emplace_back(known.second);
  return names;
}

std::string_view variant_name(Variant variant) {
  for (const auto& [value, name] : kNames)
    if (value == variant) return name;
  return {};
}

std::optional<Variant> variant_named(std::string_view name) {
  for (const auto& [value, known] : kNames)
    if (known == name) return value;
  return std::nullopt;
}

const std::optional<Estimate>& estimate_of(const Comparison& comparison, Variant variant) {
  switch (variant) {
    case Variant::kSolid:
      return comparison.solid;
    case Variant::kHollow:
      return comparison.hollow;
    case Variant::kPacked:
      return comparison.packed;
    case Variant::kCheapest:
      return estimate_of(comparison, cheapest(comparison).value_or(Variant::kPacked));
  }
  return comparison.packed;
}

std::optional<Variant> cheapest(const Comparison& comparison) {
  const std::optional<Variant> piece = cheapest_piece(comparison);
  if (!comparison.packed) return piece;
  const bool packs = !piece || pays(*comparison.packed, *estimate_of(comparison, *piece));
  return packs ? Variant::kPacked : piece;
}

std::string why_not(const Comparison& comparison, Variant variant) {
  const auto refused = comparison.refused.find(variant_name(variant));
  if (refused != comparison.refused.end()) return refused->second.what;
  return "it does not fit, " + std::string(variant_name(variant));
}

Advice advice(const Comparison& comparison) {
  const std::optional<Variant> best = cheapest(comparison);
  const bool is_refused = !comparison.refused.empty();
  if (!best)
    return {best, is_refused ? "It can be made for this printer in no way."
                             : "It fits this printer in no way; try another profile."};
  const std::optional<Variant> piece = cheapest_piece(comparison);
  if (!piece)
    return {best, is_refused ? "Pack it: in one piece it cannot be made for this printer."
                             : "Pack it: in one piece it does not fit this printer."};
  const std::string name(variant_name(*piece));
  if (!comparison.packed)
    return {best, "It cannot be packed for this printer; print it " + name + ", in one piece."};
  const Estimate& packed = *comparison.packed;
  const Estimate& other = *estimate_of(comparison, *piece);
  return {best, *best == Variant::kPacked ? for_packing(packed, other, name)
                                          : against_packing(packed, other, name)};
}

}  // namespace packmerger
