#include "http/part_names.h"

#include <strings.h>

#include <algorithm>

namespace packmerger {
namespace {

// As libmicrohttpd reads it: all that follows, less its quotes.
std::string_view boundary_in(std::string_view content_type) {
  constexpr std::string_view kKey = "boundary=";
  for (std::size_t at = 0; at + kKey.size() < content_type.size(); ++at) {
    if (::strncasecmp(content_type.data() + at, kKey.data(), kKey.size()) != 0) continue;
    std::string_view boundary = content_type.substr(at + kKey.size());
    if (boundary.size() > 1 && boundary.front() == '"' && boundary.back() == '"')
      boundary = boundary.substr(1, boundary.size() - 2);
    return boundary;
  }
  return {};
}

}  // namespace

PartNames::PartNames(std::string_view content_type) {
  const std::string_view boundary = boundary_in(content_type);
  if (!boundary.empty()) delimiter_ = "\r\n--" + std::string(boundary);
}

std::string PartNames::pass(std::string_view bytes) {
  if (delimiter_.empty()) return std::string(bytes);
  std::string to;
  to.reserve(bytes.size() + 2);
  while (!bytes.empty()) {
    if (!in_headers_) {
      bytes = copy_content(bytes, to);
    } else {
      take_header_byte(bytes.front(), to);
      bytes.remove_prefix(1);
    }
  }
  return to;
}

// Up to the end of the next delimiter; returns what is left. The delimiter's first byte is nowhere
// else in it, so that a match that fails can only begin anew with the byte at hand.
std::string_view PartNames::copy_content(std::string_view bytes, std::string& to) {
  std::size_t end = 0;
  while (end < bytes.size() && matched_ < delimiter_.size()) {
    if (matched_ == 0) end = std::min(bytes.find('\r', end), bytes.size());
    if (end == bytes.size()) break;
    const char c = bytes[end++];
    matched_ = c == delimiter_[matched_] ? matched_ + 1 : (c == '\r' ? 1 : 0);
  }
  to += bytes.substr(0, end);
  if (matched_ == delimiter_.size()) {
    in_headers_ = true;
    matched_ = 0;
    before_ = 0;
    line_bytes_ = 1;  // the delimiter's own line
  }
  return bytes.substr(end);
}

// The headers end with an empty line; \r, \n and both end one, as for libmicrohttpd.
void PartNames::take_header_byte(char c, std::string& to) {
  if (escapes_) {
    escapes_ = false;
    to += c == '"' ? "%22" : std::string{'\\', c};
  } else if (c == '\\') {
    escapes_ = true;
  } else {
    to += c;
  }
  const char before = before_;
  before_ = c;
  if (c == '\n' && before == '\r') return;
  if (c != '\r' && c != '\n') {
    ++line_bytes_;
    return;
  }
  if (line_bytes_ == 0) in_headers_ = false;
  line_bytes_ = 0;
}

std::string name_of_part(std::string_view filename) {
  constexpr std::string_view kQuote = "%22";
  std::string name(filename);
  for (std::size_t at = name.find(kQuote); at != std::string::npos; at = name.find(kQuote, at + 1))
    name.replace(at, kQuote.size(), "\"");
  return name;
}

}  // namespace packmerger
