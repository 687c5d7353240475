#include "gcode/gcode_line.h"

#include <charconv>
#include <cmath>

namespace packmerger {
namespace {

bool is_space(char c) { return c == ' ' || c == '\t'; }
bool is_small(char c) { return c >= 'a' && c <= 'z'; }
char upper(char c) { return is_small(c) ? static_cast<char>(c - 'a' + 'A') : c; }

void skip_spaces(std::string_view& text) {
  while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
}

void skip_spaces_and_brackets(std::string_view& text) {
  for (skip_spaces(text); !text.empty() && text.front() == '('; skip_spaces(text)) {
    const std::size_t end = text.find(')');
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  }
}

// No machine's; larger ones would only overflow where they are used.
constexpr double kLargest = 1e9;

// Takes a number off the front: "-1.5", "+2", ".2". Empty when there is none.
std::optional<double> take_number(std::string_view& text) {
  std::string_view rest = text;
  if (!rest.empty() && rest.front() == '+') rest.remove_prefix(1);
  double number = 0;
  const auto [end, fault] =
      std::from_chars(rest.data(), rest.data() + rest.size(), number, std::chars_format::fixed);
  if (fault != std::errc() || !(std::abs(number) <= kLargest)) return std::nullopt;
  text = rest.substr(static_cast<std::size_t>(end - rest.data()));
  return number;
}

}  // namespace

GcodeLine::GcodeLine(std::string_view text, GcodeRules rules) {
  text = text.substr(0, text.find(';'));
  std::string_view outside = text;
  skip_spaces_and_brackets(outside);
  if (outside.empty()) return;  // a comment for all: Marlin knows no command that begins so
  text = text.substr(0, text.find('*'));
  take_words(text, rules);
  if (letter_ == 0 && present_ != 0) readable_ = false;
}

void GcodeLine::take_words(std::string_view text, GcodeRules rules) {
  const bool gpx = rules == GcodeRules::kGpx;
  const auto skip = gpx ? skip_spaces_and_brackets : skip_spaces;
  for (skip(text); !text.empty(); skip(text)) {
    const char given = text.front();
    const char word = upper(given);
    if (word < 'A' || word > 'Z') {
      readable_ = false;
      return;
    }
    // most builds of Marlin pass over small letters, some take them
    if (is_small(given) && !gpx) readable_ = false;
    text.remove_prefix(1);
    skip_spaces(text);
    const std::optional<double> number = take_number(text);
    if (letter_ == 0 && word == 'N') continue;
    if (letter_ == 0 && (word == 'G' || word == 'M' || word == 'T') && number && *number >= 0 &&
        *number < 1e6) {
      letter_ = word;
      number_ = static_cast<int>(*number);
      sub_number_ = static_cast<int>(std::lround((*number - number_) * 10));
      continue;
    }
    const std::uint32_t bit = 1U << (word - 'A');
    present_ |= bit;
    if (!number) continue;
    valued_ |= bit;
    values_[word - 'A'] = *number;
  }
}

std::optional<double> GcodeLine::value(char word) const {
  if ((valued_ >> (word - 'A') & 1U) == 0) return std::nullopt;
  return values_[word - 'A'];
}

}  // namespace packmerger
