// Compressed answers (content coding gzip, RFC 9110 section 8.4; zlib).
#pragma once

#include <string>
#include <string_view>

#include "http/message.h"

namespace packmerger {

// Whether the client takes gzip (Accept-Encoding; "gzip;q=0" refuses it).
bool takes_gzip(const HttpRequest& request);

// Throws Error{kInternal} where there is no memory for it.
std::string gzipped(std::string_view bytes);

}  // namespace packmerger
