// The link by which somebody at the machine comes to the page.
#pragma once

#include <string>

#include "daemon/keys/key_ring.h"
#include "daemon/settings/config.h"

namespace packmerger {

// Where a browser beside the daemon finds the page, with a code that lets it look, once.
std::string look_link(const WebConfig& web, KeyRing& keys);

}  // namespace packmerger
