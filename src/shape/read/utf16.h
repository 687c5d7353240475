// Text in UTF-16 (RFC 2781), as Windows programs may save it.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace packmerger {

enum class ByteOrder { kLittle, kBig };

// Of text in UTF-16, told by its byte order mark or, where it has none, by every other byte of its
// beginning being zero, as of ASCII. Nullopt for anything else.
std::optional<ByteOrder> utf16_order(std::string_view bytes);

// The same text in UTF-8, with its byte order mark if it has one. What is no character becomes
// U+FFFD; an odd last byte is dropped.
std::string utf8_of(std::string_view utf16, ByteOrder order);

}  // namespace packmerger
