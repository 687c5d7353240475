// The tables [printer.NAME] of the daemon's settings. For config.cpp only.
#pragma once

#include "daemon/settings/config.h"
#include "daemon/settings/config_table.h"

namespace packmerger {

// The keys of one such table.
void read_printer_keys(TableReader& reader, const std::filesystem::path& file,
                       PrinterConfig& printer);

// All of them, into config.printers, in the order of their names; config.state is known. Refuses
// what does not go together, within one table and among them.
void read_printers(const std::filesystem::path& file, const toml::table& table,
                   DaemonConfig& config);

}  // namespace packmerger
