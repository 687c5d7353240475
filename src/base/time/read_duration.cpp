#include "base/time/read_duration.h"

#include <algorithm>
#include <array>
#include <charconv>

namespace packmerger {
namespace {

constexpr double kLongest_s = 1e9;

struct Unit {
  std::string_view name;
  double seconds;
};
constexpr std::array<Unit, 10> kUnits = {{{"d", 86400},
                                          {"day", 86400},
                                          {"days", 86400},
                                          {"h", 3600},
                                          {"hours", 3600},
                                          {"hour", 3600},
                                          {"m", 60},
                                          {"min", 60},
                                          {"s", 1},
                                          {"sec", 1}}};

bool is_digit(char c) { return c >= '0' && c <= '9'; }

void skip_spaces(std::string_view& text) {
  text.remove_prefix(std::min(text.find_first_not_of(' '), text.size()));
}

// Takes digits, with a fraction where one is allowed, off the front.
std::optional<double> take_number(std::string_view& text, bool fraction) {
  std::size_t length = 0;
  while (length < text.size() && (is_digit(text[length]) || (fraction && text[length] == '.')))
    ++length;
  if (length == 0 || !is_digit(text[0])) return std::nullopt;
  double value = 0;
  const auto [end, error] =
      std::from_chars(text.data(), text.data() + length, value, std::chars_format::fixed);
  if (error != std::errc{} || end != text.data() + length) return std::nullopt;
  text.remove_prefix(length);
  return value;
}

// Seconds of one unit, taken off the front; nothing for an unknown one.
std::optional<double> take_unit(std::string_view& text) {
  std::size_t length = 0;
  while (length < text.size() && text[length] >= 'a' && text[length] <= 'z') ++length;
  const auto* const unit = std::find_if(kUnits.begin(), kUnits.end(), [&](const Unit& one) {
    return one.name == text.substr(0, length);
  });
  if (unit == kUnits.end()) return std::nullopt;
  text.remove_prefix(length);
  return unit->seconds;
}

std::optional<double> read_clock(std::string_view text) {
  double seconds = 0;
  double unit_s = 3600;
  for (int field = 0; field < 3; ++field, unit_s /= 60) {
    const auto number = take_number(text, false);
    if (!number || (field > 0 && *number >= 60)) return std::nullopt;
    seconds += *number * unit_s;
    if (text.empty()) return field > 0 ? std::optional(seconds) : std::nullopt;
    if (text[0] != ':') return std::nullopt;
    text.remove_prefix(1);
  }
  return std::nullopt;
}

std::optional<double> read_units(std::string_view text) {
  double seconds = 0;
  double least_s = kLongest_s;  // each unit is smaller than the one before
  while (!text.empty()) {
    const auto number = take_number(text, true);
    skip_spaces(text);
    const auto unit_s = number ? take_unit(text) : std::nullopt;
    if (!unit_s || *unit_s >= least_s) return std::nullopt;
    least_s = *unit_s;
    seconds += *number * *unit_s;
    skip_spaces(text);
  }
  return seconds;
}

}  // namespace

std::optional<double> read_duration(std::string_view text) {
  skip_spaces(text);
  const auto seconds =
      text.find(':') == std::string_view::npos ? read_units(text) : read_clock(text);
  if (!seconds || !(*seconds > 0) || *seconds > kLongest_s) return std::nullopt;
  return seconds;
}

}  // namespace packmerger
