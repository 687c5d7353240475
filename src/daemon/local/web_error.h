// An error as the web server tells it.
#pragma once

#include <string>

#include "base/error.h"
#include "http/message.h"

namespace packmerger {

// {"error": {"fault", "what", "hint"}} with that status.
HttpReply web_error(int status, Fault fault, const std::string& what, const std::string& hint);

}  // namespace packmerger
