#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "model/profile/profile_keys.h"

namespace packmerger {
namespace {

template <typename... Cases>
struct Overloaded : Cases... {
  using Cases::operator()...;
};
template <typename... Cases>
Overloaded(Cases...) -> Overloaded<Cases...>;

bool inside(double value, const Limits& limits) {
  if (!std::isfinite(value) || value > limits.most) return false;
  return limits.open_below ? value > limits.least : value >= limits.least;
}

bool fits(const std::string& text, const TextForm& form) {
  return is_utf8_text(text) && (form.accepts == nullptr || form.accepts(text));
}

std::string words(const Limits& limits) {
  if (limits.open_below) return fmt::format("above {}, up to {}", limits.least, limits.most);
  return fmt::format("{} to {}", limits.least, limits.most);
}

std::string joined(const std::vector<std::string>& names) {
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
  return list;
}

bool assign_number(const NumberKey& key, const RawValue& raw) {
  double value = 0;
  if (const auto* whole = std::get_if<std::int64_t>(&raw))
    value = static_cast<double>(*whole);
  else if (const auto* number = std::get_if<double>(&raw))
    value = *number;
  else
    return false;
  if (!inside(value, key.limits)) return false;
  *key.value = value;
  return true;
}

bool assign_integer(const IntegerKey& key, const RawValue& raw) {
  const auto* value = std::get_if<std::int64_t>(&raw);
  if (value == nullptr || !inside(static_cast<double>(*value), key.limits)) return false;
  *key.value = static_cast<int>(*value);
  return true;
}

bool assign_text(const TextKey& key, const RawValue& raw) {
  const auto* value = std::get_if<std::string>(&raw);
  if (value == nullptr || !fits(*value, key.form)) return false;
  *key.value = *value;
  return true;
}

bool assign_choice(const ChoiceKey& key, const RawValue& raw) {
  const auto* value = std::get_if<std::string>(&raw);
  if (value == nullptr) return false;
  const auto found = std::ranges::find(key.names, *value);
  if (found == key.names.end()) return false;
  key.set(static_cast<std::size_t>(found - key.names.begin()));
  return true;
}

bool assign_numbers3(const Numbers3Key& key, const RawValue& raw) {
  const auto* values = std::get_if<std::vector<double>>(&raw);
  if (values == nullptr || values->size() != 3) return false;
  for (const double value : *values)
    if (!inside(value, key.limits)) return false;
  std::ranges::copy(*values, key.value->begin());
  return true;
}

bool is_empty_list(const RawValue& raw) {
  const auto* texts = std::get_if<std::vector<std::string>>(&raw);
  return texts != nullptr && texts->empty();
}

bool is_finite(const Polygon& polygon) {
  return polygon.size() <= kMostCorners &&
         std::ranges::all_of(polygon, [](const Vec2& at) { return at.allFinite(); });
}

// What makes a polygon of them depends on other keys too: missing_for_abilities() tells.
bool assign_polygon(const PolygonKey& key, const RawValue& raw) {
  if (is_empty_list(raw)) {
    key.value->clear();
    return true;
  }
  const auto* value = std::get_if<Polygon>(&raw);
  if (value == nullptr || !is_finite(*value)) return false;
  *key.value = *value;
  return true;
}

bool assign_polygons(const PolygonsKey& key, const RawValue& raw) {
  if (is_empty_list(raw)) {
    key.value->clear();
    return true;
  }
  const auto* value = std::get_if<std::vector<Polygon>>(&raw);
  if (value == nullptr || !std::ranges::all_of(*value, is_finite)) return false;
  *key.value = *value;
  return true;
}

bool assign_texts(const TextsKey& key, const RawValue& raw) {
  const auto* values = std::get_if<std::vector<std::string>>(&raw);
  if (values == nullptr) return false;
  for (const std::string& value : *values)
    if (!fits(value, key.form)) return false;
  *key.value = *values;
  return true;
}

bool is_option_name(std::string_view name) {
  return !name.empty() &&
         name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_") == name.npos;
}

bool assign_table(const TextTableKey& key, const RawValue& raw) {
  const auto* values = std::get_if<std::map<std::string, std::string>>(&raw);
  if (values == nullptr) return false;
  for (const auto& [name, value] : *values)
    if (!is_option_name(name) || !fits(value, key.form)) return false;
  for (const auto& [name, value] : *values) (*key.value)[name] = value;
  return true;
}

std::string points_range() { return fmt::format("3 to {} corners, [x, y]", kMostCorners); }

}  // namespace

bool assign(const Key& key, const RawValue& raw) {
  return std::visit(Overloaded{[&](const NumberKey& kind) { return assign_number(kind, raw); },
                               [&](const IntegerKey& kind) { return assign_integer(kind, raw); },
                               [&](const TextKey& kind) { return assign_text(kind, raw); },
                               [&](const ChoiceKey& kind) { return assign_choice(kind, raw); },
                               [&](const Numbers3Key& kind) { return assign_numbers3(kind, raw); },
                               [&](const PolygonKey& kind) { return assign_polygon(kind, raw); },
                               [&](const PolygonsKey& kind) { return assign_polygons(kind, raw); },
                               [&](const TextsKey& kind) { return assign_texts(kind, raw); },
                               [&](const TextTableKey& kind) { return assign_table(kind, raw); }},
                    key.kind);
}

std::string type_name(const Key& key) {
  return std::visit(Overloaded{[](const NumberKey&) -> std::string { return "number"; },
                               [](const IntegerKey&) -> std::string { return "integer"; },
                               [](const TextKey&) -> std::string { return "text"; },
                               [](const ChoiceKey& kind) -> std::string {
                                 return "one of " + joined(kind.names);
                               },
                               [](const Numbers3Key&) -> std::string { return "3 numbers"; },
                               [](const PolygonKey&) -> std::string { return "points"; },
                               [](const PolygonsKey&) -> std::string { return "lists of points"; },
                               [](const TextsKey&) -> std::string { return "texts"; },
                               [](const TextTableKey&) -> std::string { return "table of texts"; }},
                    key.kind);
}

std::string range_text(const Key& key) {
  return std::visit(Overloaded{[](const NumberKey& kind) { return words(kind.limits); },
                               [](const IntegerKey& kind) { return words(kind.limits); },
                               [](const TextKey& kind) { return kind.form.words; },
                               [](const ChoiceKey&) { return std::string(); },
                               [](const Numbers3Key& kind) { return "each " + words(kind.limits); },
                               [](const PolygonKey&) { return points_range(); },
                               [](const PolygonsKey&) { return "each " + points_range(); },
                               [](const TextsKey& kind) { return "each " + kind.form.words; },
                               [](const TextTableKey& kind) { return "each " + kind.form.words; }},
                    key.kind);
}

std::string expected(const Key& key) {
  std::string text = type_name(key);
  if (const std::string range = range_text(key); !range.empty()) text += ", " + range;
  if (!key.unit.empty()) text += " (" + key.unit + ")";
  return text;
}

bool is_profile_id(std::string_view text) {
  return !text.empty() && text.front() != '.' && std::ranges::all_of(text, [](unsigned char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '-' ||
           c == '_' || c == '.';
  });
}

bool is_utf8_text(std::string_view text) {
  for (std::size_t i = 0; i < text.size();) {
    const auto lead = static_cast<unsigned char>(text[i]);
    if (lead < 0x80) {
      if ((lead < 0x20 && lead != '\t' && lead != '\n' && lead != '\r') || lead == 0x7f)
        return false;
      ++i;
      continue;
    }
    const int more = lead >= 0xf0 ? 3 : lead >= 0xe0 ? 2 : 1;
    if (lead < 0xc2 || lead > 0xf4 || i + more >= text.size()) return false;
    std::uint32_t point = lead & (0x3fU >> more);
    for (int k = 1; k <= more; ++k) {
      const auto next = static_cast<unsigned char>(text[i + k]);
      if ((next & 0xc0) != 0x80) return false;
      point = (point << 6) | (next & 0x3fU);
    }
    const bool overlong = (more == 2 && point < 0x800) || (more == 3 && point < 0x10000);
    if (overlong || point > 0x10ffff || (point >= 0xd800 && point < 0xe000)) return false;
    i += static_cast<std::size_t>(more) + 1;
  }
  return true;
}

}  // namespace packmerger
