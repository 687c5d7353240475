// What every way of delivery with a port asks of a printer's settings.
#pragma once

#include <optional>
#include <string>

#include "base/files.h"

namespace packmerger {

// A port, and no folder; as DeliveryWay::fault_of_settings.
inline std::optional<std::string> fault_of_port_settings(const std::string& port,
                                                         const fs::path& handoff_folder) {
  if (port.empty()) return "needs the key port";
  if (!handoff_folder.empty()) return "cannot have a handoff_folder: this printer is sent its job";
  return std::nullopt;
}

}  // namespace packmerger
