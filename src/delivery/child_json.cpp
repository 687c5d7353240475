#include "delivery/child_json.h"

#include <cstdint>

#include "base/error.h"
#include "base/json_values.h"
#include "base/names.h"
#include "delivery/job_folder.h"
#include "tray/comparison_json.h"

namespace packmerger {
namespace {

using nlohmann::json;

constexpr int kDeepest = 64;
constexpr double kLargest = 1e15;  // of any figure
constexpr std::size_t kMostWays = 16;
constexpr std::size_t kLongest = 2000;  // bytes of a text
constexpr std::int64_t kMostPieces = 1000000;

[[noreturn]] void refuse(const std::string& what) {
  throw Error(Fault::kBadInput, "What was prepared cannot be understood: " + what, kPrepareAnew);
}

// A way that does not fit has no figures: null, or none at all. What a program does not tell is
// null too, but never its time.
void check_way(const std::string& name, const json& way) {
  if (!way.is_object()) refuse("the estimate " + printable(name) + " is no object");
  const auto fits = way.find("fits");
  if (fits == way.end() || !fits->is_boolean()) refuse("fits is neither true nor false");
  const auto has = [&](const char* key) {
    const auto found = way.find(key);
    return found != way.end() && !found->is_null();
  };
  if (fits->get<bool>() && way.contains("time_s") && way.at("time_s").is_null())
    refuse("the estimate's time_s is null");
  for (const char* key : {"time_s", "cost", "model_g", "support_g", "material_cost", "machine_cost",
                          "hands_cost", "model_mm3", "support_mm3", "assembly_min"})
    if (has(key)) {
      const json& figure = way.at(key);
      if (!figure.is_number() || figure.get<double>() < 0 || figure.get<double>() > kLargest)
        refuse(std::string("the estimate's ") + key + " is no figure from 0 up");
    }
  for (const char* key : {"parts", "trays"})
    if (has(key)) whole_number_in(way, key, 0, kMostPieces);
  for (const char* key : {"currency", "source", "reason", "hint"})
    if (has(key)) text_in(way, key);
}

}  // namespace

json parse_child_json(std::string_view text) {
  bool too_deep = false;
  const auto watch = [&](int depth, json::parse_event_t, json&) {
    too_deep = too_deep || depth > kDeepest;
    return !too_deep;
  };
  json value = json::parse(text, watch, false);
  return too_deep ? json(json::value_t::discarded) : value;
}

void check_estimates(const json& ways) {
  if (!ways.is_object() || ways.size() > kMostWays) refuse("it has no estimates");
  for (const auto& item : ways.items()) check_way(item.key(), item.value());
}

std::string compared_estimates(std::string_view out) {
  const json all = parse_child_json(out);
  if (!all.is_object() || all.size() != 1) refuse("the comparison names no printer");
  json ways = *all.begin();
  if (ways.is_object()) ways.erase("advice");  // the daemon finds it out itself
  check_estimates(ways);
  return json_text(ways);
}

std::optional<Comparison> comparison_in(const std::string& estimates) {
  const json ways = json::parse(estimates, nullptr, false);
  if (!ways.is_object()) return std::nullopt;
  try {
    return comparison_of(ways);
  } catch (const json::exception&) {
    return std::nullopt;
  }
}

std::int64_t whole_number_in(const json& object, const char* key, std::int64_t least,
                             std::int64_t most) {
  const auto found = object.find(key);
  const bool is_whole = found != object.end() && found->is_number_integer();
  const bool is_huge = is_whole && found->is_number_unsigned() &&
                       found->get<std::uint64_t>() > static_cast<std::uint64_t>(most);
  if (!is_whole || is_huge || found->get<std::int64_t>() < least ||
      found->get<std::int64_t>() > most)
    refuse(std::string(key) + " is no whole number from " + std::to_string(least) + " to " +
           std::to_string(most));
  return found->get<std::int64_t>();
}

std::string text_in(const json& object, const char* key) {
  const auto found = object.find(key);
  if (found == object.end() || !found->is_string()) refuse(std::string(key) + " is no text");
  return printable(found->get<std::string>().substr(0, kLongest));
}

}  // namespace packmerger
