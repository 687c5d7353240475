#include "base/names.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>
#include <utility>

namespace packmerger {
namespace {

struct Character {
  std::size_t bytes = 1;
  std::uint32_t code = 0;
  bool valid = false;
};

bool continues(char c) { return (static_cast<unsigned char>(c) & 0xC0U) == 0x80U; }

// The character that `text`, which is not empty, begins with.
Character first_character(std::string_view text) {
  const auto lead = static_cast<unsigned char>(text[0]);
  if (lead < 0x80) return {1, lead, true};
  const std::size_t bytes = lead >= 0xF0 ? 4 : lead >= 0xE0 ? 3 : 2;
  if (lead < 0xC2 || lead > 0xF4 || text.size() < bytes) return {};
  std::uint32_t code = lead & (0x7FU >> bytes);
  for (std::size_t i = 1; i < bytes; ++i) {
    if (!continues(text[i])) return {};
    code = code << 6U | (static_cast<unsigned char>(text[i]) & 0x3FU);
  }
  constexpr std::array<std::uint32_t, 3> kLeast = {0x80, 0x800, 0x10000};
  const bool surrogate = code >= 0xD800 && code <= 0xDFFF;
  if (code < kLeast[bytes - 2] || code > 0x10FFFF || surrogate) return {};
  return {bytes, code, true};
}

bool can_be_shown(std::uint32_t code) {
  constexpr std::array<std::pair<std::uint32_t, std::uint32_t>, 13> kHidden = {{
      {0x00, 0x1F},        // controls
      {0x7F, 0x9F},        // DEL and the second set of controls
      {0xAD, 0xAD},        // soft hyphen
      {0x61C, 0x61C},      // Arabic letter mark
      {0x180E, 0x180E},    // Mongolian vowel separator
      {0x200B, 0x200F},    // without width; marks of direction
      {0x2028, 0x202E},    // separators; embeddings and overrides of direction
      {0x2060, 0x206F},    // invisible operators; isolates of direction
      {0xFEFF, 0xFEFF},    // byte order mark
      {0xFFF0, 0xFFFB},    // interlinear annotations
      {0xE0000, 0xE0FFF},  // tags, more variation selectors
      {0x115F, 0x1160},    // Hangul fillers
      {0x3164, 0x3164},
  }};
  return std::none_of(kHidden.begin(), kHidden.end(), [code](const auto& range) {
    return code >= range.first && code <= range.second;
  });
}

std::string shown(std::string_view text, char instead, std::string_view kept) {
  std::string result;
  while (!text.empty()) {
    const Character character = first_character(text);
    const bool stays = character.valid && (can_be_shown(character.code) ||
                                           kept.find(text[0]) != std::string_view::npos);
    if (stays)
      result += text.substr(0, character.bytes);
    else
      result += instead;
    text.remove_prefix(character.bytes);
  }
  return result;
}

bool is_device(std::string_view name) {
  std::string stem(name.substr(0, name.find('.')));
  while (!stem.empty() && stem.back() == ' ') stem.pop_back();
  for (char& c : stem) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  constexpr std::array<std::string_view, 6> kDevices = {"CON", "PRN",    "AUX",
                                                        "NUL", "CONIN$", "CONOUT$"};
  if (std::find(kDevices.begin(), kDevices.end(), stem) != kDevices.end()) return true;
  const bool numbered = stem.compare(0, 3, "COM") == 0 || stem.compare(0, 3, "LPT") == 0;
  constexpr std::array<std::string_view, 3> kRaised = {"\xC2\xB9", "\xC2\xB2", "\xC2\xB3"};
  const std::string_view number = numbered ? std::string_view(stem).substr(3) : "";
  return (number.size() == 1 && number[0] >= '0' && number[0] <= '9') ||
         std::find(kRaised.begin(), kRaised.end(), number) != kRaised.end();
}

}  // namespace

std::string printable(std::string_view text, char instead) { return shown(text, instead, ""); }

std::string printable_lines(std::string_view text) { return shown(text, '?', "\n\t"); }

std::string first_bytes(std::string_view text, std::size_t bytes) {
  if (text.size() > bytes) {
    while (bytes > 0 && continues(text[bytes])) --bytes;
    text = text.substr(0, bytes);
  }
  return std::string(text);
}

std::string last_bytes(std::string_view text, std::size_t bytes) {
  if (text.size() > bytes) {
    text.remove_prefix(text.size() - bytes);
    while (!text.empty() && continues(text[0])) text.remove_prefix(1);
  }
  return std::string(text);
}

std::string portable_name(std::string_view name) {
  constexpr std::size_t kLongest = 150;
  std::string result = printable(name, '_');
  for (char& c : result)
    if (std::string_view("<>:\"/\\|?*").find(c) != std::string_view::npos) c = '_';
  result = first_bytes(result, kLongest);
  result.erase(result.find_last_not_of(". ") + 1);
  if (result.empty() || is_device(result)) result.insert(0, "_");
  return result;
}

}  // namespace packmerger
