// packmergerd: watches folders, prepares what is dropped there, and prints it.
#include <signal.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <iostream>

#include "base/error.h"
#include "daemon/config.h"
#include "daemon/loop.h"

namespace {

using packmerger::Error;
using packmerger::Fault;

void log(const std::string& line) { std::cerr << line + "\n" << std::flush; }

int run(const std::string& file) {
  const packmerger::DaemonConfig config = packmerger::read_config(file);
  if (::access(config.prepare.program.c_str(), X_OK) != 0)
    throw Error(Fault::kBadProfile,
                "The program that prepares jobs is not there: " + config.prepare.program.string(),
                "Install packmerger beside packmergerd, or name it in [prepare] program.");
  if (::geteuid() == 0)
    log("warning: running as root; a user of its own in the group dialout is enough");
  ::signal(SIGPIPE, SIG_IGN);  // whoever read our messages may go away
  packmerger::run_daemon(config, log);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App program("Watches folders, prepares the models dropped there, and prints them.",
                   "packmergerd");
  std::string config;
  program.set_version_flag("--version", PACKMERGER_VERSION);
  program.add_option("--config", config, "The settings, a TOML file (docs/DAEMON.md)")
      ->required()
      ->type_name("FILE");
  try {
    program.parse(argc, argv);
    return run(config);
  } catch (const CLI::ParseError& error) {
    return program.exit(error) == 0 ? 0 : static_cast<int>(Fault::kUsage);
  } catch (const Error& error) {
    log(std::string("error: ") + error.what());
    if (!error.hint().empty()) log("hint: " + error.hint());
    return error.exit_code();
  } catch (const std::exception& error) {
    log(std::string("error: ") + error.what());
    return static_cast<int>(Fault::kInternal);
  }
}
