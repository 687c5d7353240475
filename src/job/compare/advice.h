// Which way of printing a model is best: one answer for the command line, job.json, the daemon and
// its page.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "model/estimate.h"

namespace packmerger {

// What prepare --variant takes.
enum class Variant { kPacked, kHollow, kSolid, kCheapest };

// Their names in that order, "packed", "hollow", "solid", "cheapest": the one list of them.
std::vector<std::string> variant_names();
// The name of one, and the inverse; empty where it is none of these.
std::string_view variant_name(Variant variant);
std::optional<Variant> variant_named(std::string_view name);

// What that way of printing takes; empty where it does not fit. Of the cheapest: of cheapest().
const std::optional<Estimate>& estimate_of(const Comparison& comparison, Variant variant);

// The cheapest way that fits among packed, hollow and solid; empty where none does. Ties go to the
// way with less gluing: solid, then hollow, then packed. Where the machine's hours have no price,
// packing must not take longer either.
std::optional<Variant> cheapest(const Comparison& comparison);

// Why that way has no figures: "it does not fit, packed", or what keeps it from being made.
std::string why_not(const Comparison& comparison, Variant variant);

struct Advice {
  std::optional<Variant> variant;  // cheapest()
  std::string text;                // whether packing is worth it, and what to do: a sentence
};
Advice advice(const Comparison& comparison);

// Costs that differ by less do not show in a price.
constexpr double kSameCost = 0.005;

}  // namespace packmerger
