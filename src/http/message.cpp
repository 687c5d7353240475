#include "http/message.h"

#include <strings.h>

namespace packmerger {

std::string_view HttpRequest::header(std::string_view name) const {
  for (const auto& [known, value] : headers)
    if (known.size() == name.size() && ::strncasecmp(known.data(), name.data(), name.size()) == 0)
      return value;
  return {};
}

}  // namespace packmerger
