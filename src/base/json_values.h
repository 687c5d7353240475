// Small turns between what the store keeps and JSON, where "nothing" is null.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

namespace packmerger {

// On one line; bytes that are no UTF-8 are replaced.
inline std::string json_text(const nlohmann::json& value) {
  return value.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

// JSON text; null where it holds nothing of that type.
inline nlohmann::json parsed_or_null(const std::string& text, nlohmann::json::value_t type) {
  nlohmann::json value = nlohmann::json::parse(text, nullptr, false);
  return value.type() == type ? value : nlohmann::json();
}

inline nlohmann::json object_or_null(const std::string& text) {
  return parsed_or_null(text, nlohmann::json::value_t::object);
}

inline nlohmann::json list_or_null(const std::string& text) {
  return parsed_or_null(text, nlohmann::json::value_t::array);
}

inline nlohmann::json or_null(double value) {
  return value == 0 ? nlohmann::json() : nlohmann::json(value);
}

inline nlohmann::json or_null(std::int64_t id) {
  return id == 0 ? nlohmann::json() : nlohmann::json(id);
}

inline nlohmann::json or_null(const std::string& text) {
  return text.empty() ? nlohmann::json() : nlohmann::json(text);
}

}  // namespace packmerger
