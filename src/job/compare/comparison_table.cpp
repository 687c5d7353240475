#include "job/compare/comparison_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "base/names.h"
#include "job/compare/advice.h"

namespace packmerger {
namespace {

using Cells = std::vector<std::string>;

// A way of printing, or several whose figures read the same.
struct Way {
  std::string name;
  const Estimate* estimate = nullptr;  // nothing where it does not fit or cannot be made
  const Refusal* refusal = nullptr;    // why it cannot
};

const Estimate* cheapest_unpacked(const Comparison& comparison) {
  const Estimate* best = nullptr;
  for (const std::optional<Estimate>* way :
       {&comparison.as_is, &comparison.solid, &comparison.hollow})
    if (*way && (best == nullptr || (*way)->cost < best->cost)) best = &**way;
  return best;
}

// "-31 %"; empty where there is nothing to compare with, a dash for the yardstick itself.
std::string difference(const Estimate& way, const Estimate* yardstick, double Estimate::*figure) {
  if (yardstick == nullptr) return "";
  if (yardstick == &way) return "-";
  if (yardstick->*figure == 0) return way.*figure == 0 ? "0 %" : "";
  return fmt::format("{:+.0f} %", 100 * (way.*figure / yardstick->*figure - 1));
}

std::string grams(double g) { return fmt::format("{:.1f} g", g); }

std::string by_hand(const Estimate& way) {
  return way.assembly_min > 0 ? spoken_time(60 * way.assembly_min) : "none";
}

std::string money(const Estimate& way, double amount) {
  return fmt::format("{:.2f} {}", amount, way.currency);
}

// What an earlier version compared tells no sums.
std::string sum_of(const Estimate& way, double amount) {
  const double all = way.material_cost + way.machine_cost + way.hands_cost;
  return std::abs(all - way.cost) < kSameCost ? money(way, amount) : "-";
}

const Cells kMoneyTitles = {"cost", "", "material", "machine", "hands"};

// What weighs something and stands below nothing is no support: powder that cannot be used again.
bool is_in_powder(const std::vector<Way>& ways) {
  const auto holds = [&](bool (*is)(const Estimate&)) {
    return std::any_of(ways.begin(), ways.end(), [&](const Way& way) {
      return way.estimate != nullptr && is(*way.estimate);
    });
  };
  return holds([](const Estimate& one) { return one.support_g > 0; }) &&
         !holds([](const Estimate& one) { return one.support_mm3 > 0; });
}

Cells figure_titles(const std::vector<Way>& ways) {
  return {"time", "",      "model", is_in_powder(ways) ? "lost powder" : "support",
          "",     "parts", "trays", "by hand"};
}

Cells figures_of(const Estimate& way, const Estimate* yardstick) {
  return {spoken_time(way.time_s),
          difference(way, yardstick, &Estimate::time_s),
          grams(way.model_g),
          grams(way.support_g),
          difference(way, yardstick, &Estimate::support_g),
          std::to_string(way.parts),
          std::to_string(way.trays),
          by_hand(way)};
}

Cells money_of(const Estimate& way, const Estimate* yardstick) {
  return {money(way, way.cost), difference(way, yardstick, &Estimate::cost),
          sum_of(way, way.material_cost), sum_of(way, way.machine_cost),
          sum_of(way, way.hands_cost)};
}

bool read_the_same(const Estimate& a, const Estimate& b) {
  return figures_of(a, nullptr) == figures_of(b, nullptr) &&
         money_of(a, nullptr) == money_of(b, nullptr);
}

std::vector<Way> ways_of(const Comparison& comparison) {
  std::vector<Way> ways;
  const auto add = [&](const std::string& name, const char* key,
                       const std::optional<Estimate>& estimate) {
    const auto same = std::find_if(ways.begin(), ways.end(), [&](const Way& way) {
      return estimate && way.estimate != nullptr && read_the_same(*estimate, *way.estimate);
    });
    const auto refused = comparison.refused.find(key);
    if (same == ways.end())
      ways.push_back({name, estimate ? &*estimate : nullptr,
                      refused != comparison.refused.end() ? &refused->second : nullptr});
    else
      same->name += " = " + name;
  };
  add("as the file stands", "as_is", comparison.as_is);
  add("solid, best way up", "solid", comparison.solid);
  add("hollow, one piece", "hollow", comparison.hollow);
  add("packed", "packed", comparison.packed);
  return ways;
}

// A row of one cell says why there are no figures.
Cells row_of(const Way& way, const Estimate* yardstick) {
  if (way.estimate != nullptr) return figures_of(*way.estimate, yardstick);
  return {way.refusal != nullptr ? "cannot be made, see below" : "does not fit"};
}

// A paragraph for each reason, as several ways often have one.
std::string why_not(const std::vector<Way>& ways) {
  std::string text;
  for (auto way = ways.begin(); way != ways.end(); ++way) {
    const auto has_reason = [&](const Way& other) {
      return other.refusal != nullptr && other.refusal->what == way->refusal->what;
    };
    if (way->refusal == nullptr || std::any_of(ways.begin(), way, has_reason)) continue;
    text += way->name;
    for (auto other = way + 1; other != ways.end(); ++other)
      if (has_reason(*other)) text += "; " + other->name;
    text += fmt::format(": {}. {}\n", printable(way->refusal->what), printable(way->refusal->hint));
  }
  return text;
}

// Names to the left, cells to the right, columns as wide as they need to be; a row of one cell is
// words.
std::string aligned(const Cells& names, const std::vector<Cells>& rows) {
  std::size_t name_width = 0;
  std::vector<std::size_t> widths(rows.front().size());
  for (const std::string& name : names) name_width = std::max(name_width, name.size());
  for (const Cells& row : rows)
    for (std::size_t i = 0; row.size() > 1 && i < row.size(); ++i)
      widths[i] = std::max(widths[i], row[i].size());
  std::string text;
  for (std::size_t line = 0; line < rows.size(); ++line) {
    text += fmt::format("{:<{}}", names[line], name_width);
    if (rows[line].size() == 1)
      text += "  " + rows[line].front();
    else
      for (std::size_t i = 0; i < rows[line].size(); ++i)
        if (widths[i] > 0) text += fmt::format("  {:>{}}", rows[line][i], widths[i]);
    text += "\n";
  }
  return text;
}

std::string source_of(const Comparison& comparison) {
  const Estimate* any = cheapest_unpacked(comparison);
  if (any == nullptr && comparison.packed) any = &*comparison.packed;
  if (any == nullptr) return "";
  return any->source == EstimateSource::kSlicer
             ? "Figures come from slicing every way.\n"
             : "Figures come from the profile's model of the machine (docs/ESTIMATES.md).\n";
}

// Where nothing is prepared yet, packed is what would be.
std::string what_to_do(const Advice& advice, std::string_view prepared, const std::string& taking) {
  const std::string_view now = prepared.empty() ? variant_name(Variant::kPacked) : prepared;
  if (!advice.variant || variant_name(*advice.variant) == now) return "";
  return fmt::format(" Use {} {}.", taking, variant_name(*advice.variant));
}

}  // namespace

std::string spoken_time(double seconds) {
  const long rounded = std::lround(seconds);
  if (rounded < 60) return fmt::format("{} s", rounded);
  const long minutes = std::lround(seconds / 60);
  if (minutes < 60) return fmt::format("{} min", minutes);
  return fmt::format("{} h {:02} min", minutes / 60, minutes % 60);
}

std::string comparison_table(const Comparison& comparison, const std::string& title,
                             std::string_view prepared, const std::string& taking) {
  const Estimate* yardstick = cheapest_unpacked(comparison);
  Cells names = {""};
  const std::vector<Way> ways = ways_of(comparison);
  std::vector<Cells> figures = {figure_titles(ways)};
  Cells paid_names = {""};
  std::vector<Cells> paid = {kMoneyTitles};
  for (const Way& way : ways) {
    names.push_back(way.name);
    figures.push_back(row_of(way, yardstick));
    if (way.estimate == nullptr) continue;
    paid_names.push_back(way.name);
    paid.push_back(money_of(*way.estimate, yardstick));
  }
  std::string text = title + "\n" + aligned(names, figures);
  if (paid.size() > 1) text += "\n" + aligned(paid_names, paid);
  if (const std::string reasons = why_not(ways); !reasons.empty()) text += "\n" + reasons + "\n";
  const Advice told = advice(comparison);
  return text + source_of(comparison) + told.text + what_to_do(told, prepared, taking) + "\n";
}

}  // namespace packmerger
