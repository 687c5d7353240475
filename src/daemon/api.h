// What the daemon answers to the requests of docs/DAEMON.md: JSON in, JSON out. Runs on the loop's
// thread and touches nothing but the foreman.
#pragma once

#include <string>
#include <string_view>

#include "daemon/foreman.h"

namespace packmerger {

// One request, one reply, both without a line end. A request that cannot be understood or done is
// answered too: {"ok": false, "error": {"fault", "what", "hint"}}; nothing is thrown for it.
std::string answer(Foreman& foreman, std::string_view request);

}  // namespace packmerger
