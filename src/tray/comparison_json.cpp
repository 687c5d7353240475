#include "tray/comparison_json.h"

namespace packmerger {
namespace {

using Json = nlohmann::json;

Json estimate_json(const Comparison& comparison, const char* way,
                   const std::optional<Estimate>& estimate) {
  if (!estimate) {
    Json none = {{"fits", false}};
    for (const char* key :
         {"time_s", "model_mm3", "model_g", "support_mm3", "support_g", "cost", "material_cost",
          "machine_cost", "hands_cost", "currency", "parts", "trays", "assembly_min", "source"})
      none[key] = nullptr;
    if (const auto refused = comparison.refused.find(way); refused != comparison.refused.end()) {
      none["reason"] = refused->second.what;
      none["hint"] = refused->second.hint;
    }
    return none;
  }
  return {{"fits", true},
          {"time_s", estimate->time_s},
          {"model_mm3", estimate->model_mm3},
          {"model_g", estimate->model_g},
          {"support_mm3", estimate->support_mm3},
          {"support_g", estimate->support_g},
          {"cost", estimate->cost},
          {"material_cost", estimate->material_cost},
          {"machine_cost", estimate->machine_cost},
          {"hands_cost", estimate->hands_cost},
          {"currency", estimate->currency},
          {"parts", estimate->parts},
          {"trays", estimate->trays},
          {"assembly_min", estimate->assembly_min},
          {"source", source_name(estimate->source)}};
}

// Time and money count; other figures are left at nothing where they are missing.
std::optional<Estimate> estimate_of(const Json& ways, const char* way) {
  const auto found = ways.find(way);
  if (found == ways.end() || !found->at("fits").get<bool>()) return std::nullopt;
  const Json& json = *found;
  Estimate estimate;
  estimate.time_s = json.at("time_s");
  estimate.cost = json.at("cost");
  estimate.material_cost = json.value("material_cost", 0.0);
  estimate.machine_cost = json.value("machine_cost", 0.0);
  estimate.hands_cost = json.value("hands_cost", 0.0);
  estimate.currency = json.value("currency", "");
  estimate.model_mm3 = json.value("model_mm3", 0.0);
  estimate.model_g = json.value("model_g", 0.0);
  estimate.support_mm3 = json.value("support_mm3", 0.0);
  estimate.support_g = json.value("support_g", 0.0);
  estimate.parts = json.value("parts", 1);
  estimate.trays = json.value("trays", 1);
  estimate.assembly_min = json.value("assembly_min", 0.0);
  estimate.source = source_named(json.value("source", ""));
  return estimate;
}

// Another program's file may hold null.
std::string text_or_none(const Json& json, const char* key) {
  const auto found = json.find(key);
  return found != json.end() && found->is_string() ? found->get<std::string>() : "";
}

}  // namespace

Json comparison_json(const Comparison& comparison) {
  return {{"as_is", estimate_json(comparison, "as_is", comparison.as_is)},
          {"solid", estimate_json(comparison, "solid", comparison.solid)},
          {"hollow", estimate_json(comparison, "hollow", comparison.hollow)},
          {"packed", estimate_json(comparison, "packed", comparison.packed)}};
}

Json advice_json(std::string_view variant, const std::string& text) {
  return {{"variant", variant.empty() ? Json() : Json(variant)}, {"text", text}};
}

Comparison comparison_of(const Json& json) {
  Comparison comparison;
  comparison.as_is = estimate_of(json, "as_is");
  comparison.solid = estimate_of(json, "solid");
  comparison.hollow = estimate_of(json, "hollow");
  comparison.packed = estimate_of(json, "packed");
  for (const char* way : {"as_is", "solid", "hollow", "packed"})
    if (const auto found = json.find(way);
        found != json.end() && found->contains("reason") && found->at("reason").is_string())
      comparison.refused[way] = {found->at("reason"), text_or_none(*found, "hint")};
  return comparison;
}

}  // namespace packmerger
