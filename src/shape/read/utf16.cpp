#include "shape/read/utf16.h"

#include <cstddef>
#include <cstdint>

namespace packmerger {
namespace {

constexpr char32_t kReplacement = 0xFFFD;

bool is_high(char32_t unit) { return unit >= 0xD800 && unit < 0xDC00; }
bool is_low(char32_t unit) { return unit >= 0xDC00 && unit < 0xE000; }

void append_utf8(std::string& text, char32_t point) {
  const auto put = [&](char32_t byte) { text += static_cast<char>(byte); };
  const auto put_rest = [&](int shift) { put(0x80 | (point >> shift & 0x3F)); };
  if (point < 0x80) {
    put(point);
  } else if (point < 0x800) {
    put(0xC0 | point >> 6);
    put_rest(0);
  } else if (point < 0x10000) {
    put(0xE0 | point >> 12);
    put_rest(6);
    put_rest(0);
  } else {
    put(0xF0 | point >> 18);
    put_rest(12);
    put_rest(6);
    put_rest(0);
  }
}

}  // namespace

std::optional<ByteOrder> utf16_order(std::string_view bytes) {
  if (bytes.starts_with("\xFF\xFE")) return ByteOrder::kLittle;
  if (bytes.starts_with("\xFE\xFF")) return ByteOrder::kBig;
  constexpr std::size_t kLooked = 64;
  if (bytes.size() < kLooked) return std::nullopt;
  for (const std::size_t zero : {0, 1}) {
    bool all = true;
    for (std::size_t i = 0; i < kLooked; i += 2)
      all = all && bytes[i + zero] == 0 && bytes[i + 1 - zero] != 0;
    if (all) return zero == 0 ? ByteOrder::kBig : ByteOrder::kLittle;
  }
  return std::nullopt;
}

std::string utf8_of(std::string_view utf16, ByteOrder order) {
  const std::size_t count = utf16.size() / 2;
  const auto unit = [&](std::size_t i) {
    const auto first = static_cast<std::uint8_t>(utf16[2 * i]);
    const auto second = static_cast<std::uint8_t>(utf16[2 * i + 1]);
    return static_cast<char32_t>(order == ByteOrder::kBig ? first << 8 | second
                                                          : second << 8 | first);
  };
  std::string text;
  text.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    char32_t point = unit(i);
    if (is_high(point) && i + 1 < count && is_low(unit(i + 1)))
      point = 0x10000 + ((point - 0xD800) << 10) + (unit(++i) - 0xDC00);
    else if (is_high(point) || is_low(point))
      point = kReplacement;
    append_utf8(text, point);
  }
  return text;
}

}  // namespace packmerger
