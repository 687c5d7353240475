#include "job/comparison_table.h"

#include <fmt/format.h>

#include <cmath>
#include <optional>

namespace packmerger {
namespace {

// Less than this share of the cost is not worth gluing for.
constexpr double kLittleGain = 0.02;

const Estimate* cheapest_unpacked(const Comparison& comparison) {
  const Estimate* best = nullptr;
  for (const std::optional<Estimate>* way :
       {&comparison.as_is, &comparison.solid, &comparison.hollow})
    if (*way && (best == nullptr || (*way)->cost < best->cost)) best = &**way;
  return best;
}

// "-31 %"; empty where there is nothing to compare with, a dash for the yardstick itself.
std::string difference(double value, double yardstick, bool is_yardstick) {
  if (is_yardstick) return "-";
  if (yardstick == 0) return value == 0 ? "0 %" : "";
  return fmt::format("{:+.0f} %", 100 * (value / yardstick - 1));
}

std::string row(const std::string& name, const std::optional<Estimate>& way,
                const Estimate* yardstick) {
  if (!way) return fmt::format("{:<20} does not fit\n", name);
  const bool self = yardstick != nullptr && &*way == yardstick;
  const auto against = [&](double value, double other) {
    return yardstick == nullptr ? std::string() : difference(value, other, self);
  };
  const Estimate none;
  const Estimate& other = yardstick == nullptr ? none : *yardstick;
  return fmt::format(
      "{:<20} {:>12} {:>7} {:>9.1f} g {:>9.1f} g {:>7} {:>9.2f} {} {:>7} {:>5} {:>5}\n", name,
      spoken_time(way->time_s), against(way->time_s, other.time_s), way->model_g, way->support_g,
      against(way->support_g, other.support_g), way->cost, way->currency,
      against(way->cost, other.cost), way->parts, way->trays);
}

std::string source_of(const Comparison& comparison) {
  const Estimate* any = cheapest_unpacked(comparison);
  if (any == nullptr && comparison.packed) any = &*comparison.packed;
  if (any == nullptr) return "";
  return any->source == EstimateSource::kSlicer
             ? "Figures come from slicing every way.\n"
             : "Figures come from the profile's model of the machine (docs/ESTIMATES.md).\n";
}

}  // namespace

std::string spoken_time(double seconds) {
  const long rounded = std::lround(seconds);
  if (rounded < 60) return fmt::format("{} s", rounded);
  const long minutes = std::lround(seconds / 60);
  if (minutes < 60) return fmt::format("{} min", minutes);
  return fmt::format("{} h {:02} min", minutes / 60, minutes % 60);
}

std::string comparison_table(const Comparison& comparison, const std::string& title) {
  const Estimate* yardstick = cheapest_unpacked(comparison);
  std::string text = title + "\n";
  text += fmt::format("{:<20} {:>12} {:>7} {:>11} {:>11} {:>7} {:>13} {:>7} {:>5} {:>5}\n", "",
                      "time", "", "model", "support", "", "cost", "", "parts", "trays");
  text += row("as the file stands", comparison.as_is, yardstick);
  text += row("solid, best way up", comparison.solid, yardstick);
  text += row("hollow, one piece", comparison.hollow, yardstick);
  text += row("packed", comparison.packed, yardstick);
  return text + source_of(comparison) + recommendation(comparison) + "\n";
}

std::string recommendation(const Comparison& comparison) {
  const Estimate* unpacked = cheapest_unpacked(comparison);
  if (!comparison.packed)
    return unpacked == nullptr ? "It fits this printer in no way; try another profile."
                               : "It cannot be packed for this printer; print it in one piece.";
  const Estimate& packed = *comparison.packed;
  if (unpacked == nullptr) return "Pack it: in one piece it does not fit this printer.";
  const bool hollow = comparison.hollow && unpacked == &*comparison.hollow;
  const std::string other = hollow ? "hollow, in one piece" : "solid, in one piece";
  if (packed.cost < unpacked->cost) {
    const bool little = packed.cost > (1 - kLittleGain) * unpacked->cost;
    return fmt::format("{}: {:.2f} {} less than printing it {} ({:+.0f} % time, {:+.0f} % cost).",
                       little ? "Little is to be gained by packing" : "Pack it",
                       unpacked->cost - packed.cost, packed.currency, other,
                       100 * (packed.time_s / unpacked->time_s - 1),
                       100 * (packed.cost / unpacked->cost - 1));
  }
  const double more = packed.cost - unpacked->cost;
  const std::string costs =
      more < 0.005 ? "as little" : fmt::format("{:.2f} {} less", more, packed.currency);
  return fmt::format("Packing does not pay here: printing it {} costs {}. Use --variant {}.", other,
                     costs, hollow ? "hollow" : "solid");
}

}  // namespace packmerger
