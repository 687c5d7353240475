#include "cli/verb.h"

namespace packmerger::cli {

void add_verbs(CLI::App& program) {
  program.description(
      "Prepares a 3D model for one given printer: hollows it, divides it into parts, "
      "packs them on the tray, compares, and sends the job.");
  program.require_subcommand(1);
  program.set_version_flag("--version", "packmerger " PACKMERGER_VERSION);
  add_prepare(program);
  add_compare(program);
  add_send(program);
  add_profiles(program);
  add_calibrate(program);
  add_devices(program);
  add_jobs(program);
  add_keys(program);
  add_printers(program);
  add_simulate(program);
}

}  // namespace packmerger::cli
