#include "daemon/options.h"

namespace packmerger {

void add_options(CLI::App& program, DaemonOptions& options) {
  program.description("Watches folders, prepares the models dropped there, and prints them.");
  program.set_version_flag("--version", "packmergerd " PACKMERGER_VERSION);
  program.add_option("--config", options.config, "the settings, a TOML file (docs/DAEMON.md)")
      ->required()
      ->type_name("FILE");
  program.add_flag("--check", options.check, "reads the settings, says what is wrong, and ends");
}

}  // namespace packmerger
