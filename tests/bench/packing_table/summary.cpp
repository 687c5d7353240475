#include "bench/packing_table/summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <string_view>

namespace packmerger::bench {
namespace {

using Json = nlohmann::ordered_json;

// How a figure is told; others by their name, with two digits.
struct Shown {
  std::string_view key;
  std::string_view name;
  std::string_view unit;
  int digits;
  double factor = 1;
};
constexpr std::array kShown{
    Shown{"height_mm", "height", " mm", 2},
    Shown{"density", "density", " %", 1, 100},
    Shown{"support_cm3", "support", " cm³", 0},
    Shown{"trays", "trays", "", 0},
    Shown{"parts", "parts", "", 0},
    Shown{"cost", "cost", "", 1},
    Shown{"copies", "copies", "", 0},
    Shown{"height_ratio", "÷ nested bowls", "", 3},
    Shown{"peak_memory_mb", "memory", " MB", 0},
    Shown{"packing_ms", "ours", " ms", 0},
    Shown{"reference_s", "the paper's", " s", 0},
    Shown{"one_packing_ratio", "times faster", "", 0},
    Shown{"search_ratio", "times faster", "", 1},
    Shown{"search_with_gap_ratio", "with the gap", "", 1},
    Shown{"slower_beside_a_sweep", "beside a sweep of memory ×", "", 2},
    Shown{"kernel_fraction", "kernel", "", 2},
    Shown{"time_ratio", "time ÷ solid", "", 2},
    Shown{"support_ratio", "support ÷ solid", "", 3},
};

Shown shown(std::string_view key) {
  const auto at =
      std::find_if(kShown.begin(), kShown.end(), [&](const Shown& s) { return s.key == key; });
  return at != kShown.end() ? *at : Shown{key, key, "", 2};
}

// Median and range of one value of all runs.
std::string spread(const std::vector<double>& values, int digits, std::string_view unit) {
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  const auto told = [digits](double value) { return fmt::format("{:.{}f}", value, digits); };
  std::string text = told(median(values)) + std::string(unit);
  if (told(*least) != told(*most)) text += fmt::format(" ({}–{})", told(*least), told(*most));
  return text;
}

std::string seconds_text(const std::vector<Json>& runs, const char* key) {
  std::vector<double> values;
  for (const Json& run : runs) values.push_back(run[key]);
  const double middle = median(values);
  return fmt::format("{:.{}f}", middle, middle < 10 ? 1 : 0);
}

}  // namespace

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : (values[half - 1] + values[half]) / 2;
}

std::string figures_text(const std::vector<Json>& runs) {
  std::string text;
  for (const auto& [key, first] : runs.front()["figures"].items()) {
    const Shown how = shown(key);
    std::vector<double> values;
    for (const Json& run : runs) values.push_back(how.factor * run["figures"].value(key, 0.0));
    if (!text.empty()) text += ", ";
    text += fmt::format("{} {}", how.name, spread(values, how.digits, how.unit));
  }
  return text;
}

std::string check_text(const std::vector<Json>& runs) {
  std::string broken;
  double apart = std::numeric_limits<double>::infinity();
  int straight_up = 0, by_path = 0, trays = 0;
  for (const Json& run : runs) {
    if (!run.contains("check")) continue;
    const Json& check = run["check"];
    ++trays;
    apart = std::min(apart, check["apart_mm"].get<double>());
    straight_up += check["straight_up"].get<int>();
    by_path += check["by_path"].get<int>();
    for (const Json& what : check["broken"]) broken += what.get<std::string>() + "; ";
  }
  if (trays == 0) return "";
  return fmt::format("{}{:.4f} mm apart, {} straight up, {} by a path", broken, apart, straight_up,
                     by_path);
}

Json case_json(const TableCase& of, const std::vector<Json>& runs, const std::string& skipped) {
  Json told{{"row", of.row}, {"packer", of.packer}, {"what", of.what}, {"aim", of.aim}};
  told["runs"] = runs;
  if (!skipped.empty()) told["skipped"] = skipped;
  return told;
}

std::string packing_table_markdown(const Json& cases) {
  std::string text =
      "| what | packer | figures | runs | s | processor s | on the meshes | aim |\n"
      "|---|---|---|---|---|---|---|---|\n";
  std::string row;
  for (const Json& one : cases) {
    const bool begins = one["row"].get<std::string>() != row;
    row = one["row"];
    const auto runs = one["runs"].get<std::vector<Json>>();
    text += fmt::format("| {} | {} | ", begins ? one["what"].get<std::string>() : "",
                        one["packer"].get<std::string>());
    text += runs.empty() ? one.value("skipped", "not measured") + " | 0 | | | |"
                         : fmt::format("{} | {} | {} | {} | {} |", figures_text(runs), runs.size(),
                                       seconds_text(runs, "seconds"),
                                       seconds_text(runs, "processor_s"), check_text(runs));
    text += fmt::format(" {} |\n", begins ? one["aim"].get<std::string>() : "");
  }
  return text;
}

}  // namespace packmerger::bench
