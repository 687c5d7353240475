// packmerger simulate PROFILE: a printer that does not exist, on a pseudo-terminal.
#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <memory>
#include <string>

#include <nlohmann/json.hpp>

#include "cli/verb.h"
#include "firmware_io/simulated/simulator.h"
#include "model/printer.h"

namespace packmerger::cli {
namespace {

struct Arguments {
  std::string profile;
  double speed = 1;
  std::string record;
  bool json = false;
};

double checked_speed(double speed) {
  if (std::isinf(speed) && speed > 0) return 0;
  if (std::isfinite(speed) && speed >= 0) return speed;
  throw Error(Fault::kUsage, "The speed must be 0 or more", "Give --speed 10, or --speed inf.");
}

void simulate(const Arguments& arguments) {
  const Profile profile = read_profile(arguments.profile);
  if (!profile.is_sliced())
    throw Error(
        Fault::kUsage,
        "There is nothing to simulate for " + profile.id + ": it is given documents, not programs",
        "Choose a profile whose dialect is s3g or gcode, such as replicator or marlin.");
  const SimulatorOptions options{checked_speed(arguments.speed), arguments.record};
  const Progress signals = terminal_progress();  // for interrupted()
  const ListeningAt listening = [&](const std::string& path) {
    if (arguments.json)
      fmt::print("{}\n", nlohmann::json{{"port", path}, {"profile", profile.id}}.dump());
    else
      fmt::print("{}\n", path);
    std::fflush(stdout);
  };
  if (profile.dialect == Dialect::kS3g)
    run_simulated_replicator(options, listening, interrupted());
  else
    run_simulated_marlin(options, listening, interrupted());
}

}  // namespace

void add_simulate(CLI::App& program) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* verb = program.add_subcommand(
      "simulate",
      "Runs a printer that does not exist; its first line of output is the port it listens at");
  verb->add_option("PROFILE", arguments->profile, "A profile's id, or the path of a TOML file")
      ->required();
  verb->add_option("--speed", arguments->speed,
                   "How many times faster than a real printer; 0 or inf: no waiting at all")
      ->capture_default_str();
  verb->add_option("--record", arguments->record, "A file for every executed command, one a line");
  verb->add_flag("--json", arguments->json, "The first line as JSON");
  verb->callback([arguments] { simulate(*arguments); });
}

}  // namespace packmerger::cli
