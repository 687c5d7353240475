// Names and texts from outside: shown so that they cannot deceive, cut between characters, and made
// into names that every system can hold. Texts are UTF-8; bytes that are none count as characters
// that cannot be shown.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace packmerger {

// For messages: each character becomes `instead` that a terminal or page would obey or not show:
// controls (C0, DEL, C1), line and paragraph separators, those that turn the writing direction,
// those without width.
std::string printable(std::string_view text, char instead = '?');

// The same, but line ends and tabs stay.
std::string printable_lines(std::string_view text);

// The first, or the last, `bytes` bytes of it at most, in whole characters.
std::string first_bytes(std::string_view text, std::size_t bytes);
std::string last_bytes(std::string_view text, std::size_t bytes);

// A name for a file or folder that Linux, macOS and Windows can all hold and show: without path
// separators and <>:"|?*, at most 150 bytes, not ending in a dot or blank, none of Windows' devices
// (CON, NUL, COM1 …), not empty.
std::string portable_name(std::string_view name);

}  // namespace packmerger
