// packmergerd: watches folders, prepares what is dropped there, and prints it.
#include <signal.h>
#include <unistd.h>

#include <iostream>

#include "base/error.h"
#include "base/process/confinement.h"
#include "daemon/loop.h"
#include "daemon/options.h"
#include "daemon/settings/config.h"

namespace {

using packmerger::Error;
using packmerger::Fault;

void log(const std::string& line) { std::cerr << line + "\n" << std::flush; }

packmerger::DaemonConfig settings_in(const std::string& file) {
  packmerger::DaemonConfig config = packmerger::read_config(file);
  if (::access(config.prepare.program.c_str(), X_OK) != 0)
    throw Error(Fault::kBadProfile,
                "The program that prepares jobs is not there: " + config.prepare.program.string(),
                "Install packmerger beside packmergerd, or name it in [prepare] program.");
  return config;
}

int run(const packmerger::DaemonOptions& options) {
  const auto read = [&] { return settings_in(options.config); };
  if (options.check) {
    const std::size_t printers = read().printers.size();
    std::cout << options.config << " is good: " << printers << " printer(s)\n";
    return 0;
  }
  if (::geteuid() == 0)
    log("warning: running as root; a user of its own in the group dialout is enough");
  if (!packmerger::can_confine_files())
    log("warning: this kernel has no Landlock: what prepares models has no network, but may write "
        "wherever this user may; Linux 5.13 or newer keeps it in its job's folder");
  ::signal(SIGPIPE, SIG_IGN);  // whoever read our messages may go away
  packmerger::run_daemon(read, log);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App program;
  packmerger::DaemonOptions options;
  packmerger::add_options(program, options);
  try {
    program.parse(argc, argv);
    return run(options);
  } catch (const CLI::Success& wanted) {  // --help, --version
    return program.exit(wanted);
  } catch (const CLI::ParseError& error) {
    log(std::string("error: ") + error.what());
    log("hint: packmergerd --help tells how it is used");
    return static_cast<int>(Fault::kUsage);
  } catch (const Error& error) {
    log(std::string("error: ") + error.what());
    if (!error.hint().empty()) log("hint: " + error.hint());
    return error.exit_code();
  } catch (const std::exception& error) {
    log(std::string("error: ") + error.what());
    return static_cast<int>(Fault::kInternal);
  }
}
