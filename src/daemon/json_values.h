// Small turns from what the store keeps to JSON, where "nothing" is null.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

namespace packmerger {

// JSON text; null where it holds no object.
inline nlohmann::json object_or_null(const std::string& text) {
  nlohmann::json object = nlohmann::json::parse(text, nullptr, false);
  return object.is_object() ? object : nlohmann::json();
}

// JSON text; null where it holds no list.
inline nlohmann::json list_or_null(const std::string& text) {
  nlohmann::json list = nlohmann::json::parse(text, nullptr, false);
  return list.is_array() ? list : nlohmann::json();
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
