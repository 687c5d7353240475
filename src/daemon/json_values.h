// Small turns from what the store keeps to JSON, where "nothing" is null.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

namespace packmerger {

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
