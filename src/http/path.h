// A request's path and query (RFC 3986) as plain text.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace packmerger {

// "%41" → "A"; nothing for a lone %, for %00 and for control characters.
std::optional<std::string> percent_decoded(std::string_view text);

// One segment of a path: "a b/ü" → "a%20b%2F%C3%BC".
std::string percent_encoded(std::string_view segment);

// "/a%20b/c" → "/a b/c". Nothing for a path that does not begin with a slash, that holds an empty
// segment (but for the last), ".", "..", a backslash or a control character, or that decodes to a
// slash within a segment: names on the wire never become paths elsewhere.
std::optional<std::string> decoded_path(std::string_view target);

// "a=1&b=%20" → {a: "1", b: " "}; of a name given twice the first counts. What cannot be decoded is
// left out.
std::map<std::string, std::string> decoded_query(std::string_view query);

}  // namespace packmerger
