// Names in a form (multipart/form-data, RFC 7578) that hold a double quote. Browsers and newer
// libcurl write it as %22, libcurl before 7.81 as \" , which libmicrohttpd takes for the name's
// end.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace packmerger {

// Makes one of both ways, in a form that comes piece by piece: \" within the headers of a part
// becomes %22. No other byte is changed, and none of what the parts hold.
class PartNames {
 public:
  // content_type: the request's, with the boundary.
  explicit PartNames(std::string_view content_type);

  // The next piece as it goes on; the pieces may be cut anywhere. A backslash at a piece's end
  // comes with the next one.
  std::string pass(std::string_view bytes);

 private:
  std::string_view copy_content(std::string_view bytes, std::string& to);
  void take_header_byte(char c, std::string& to);

  std::string delimiter_;    // "\r\n--boundary"; empty: nothing is changed
  std::size_t matched_ = 2;  // bytes of it: a form begins with its second line
  bool in_headers_ = false;
  bool escapes_ = false;  // a backslash is held back
  char before_ = 0;
  std::size_t line_bytes_ = 0;
};

// The name that a part's filename stands for, once it went through the above.
std::string name_of_part(std::string_view filename);

}  // namespace packmerger
