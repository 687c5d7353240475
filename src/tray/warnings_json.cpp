#include "tray/warnings_json.h"

namespace packmerger {

nlohmann::json warnings_json(const Warnings& warnings) {
  nlohmann::json list = nlohmann::json::array();
  for (const Warning& warning : warnings)
    list.push_back({{"code", warning.code}, {"text", warning.text}});
  return list;
}

Warnings warnings_of(const nlohmann::json& json) {
  Warnings warnings;
  for (const nlohmann::json& warning : json)
    warnings.push_back({warning.at("code"), warning.at("text")});
  return warnings;
}

}  // namespace packmerger
