// A printer as people and programs are shown it.
#pragma once

#include <nlohmann/json.hpp>

#include "daemon/config.h"
#include "daemon/foreman.h"

namespace packmerger {

// What `printers list` shows; docs/DAEMON.md names the keys.
nlohmann::json printer_view(const Foreman& foreman, const PrinterConfig& printer);

}  // namespace packmerger
