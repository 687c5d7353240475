// packmerger simulate PROFILE: a printer that does not exist, on a pseudo-terminal.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

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
  std::string firmware;
  std::vector<std::string> traits;
  bool json = false;
};

double checked_speed(double speed) {
  if (std::isinf(speed) && speed > 0) return 0;
  if (std::isfinite(speed) && speed >= 0) return speed;
  throw Error(Fault::kUsage, "The speed must be 0 or more", "Give --speed 10, or --speed inf.");
}

std::string joined(const std::vector<std::string>& names) {
  return fmt::format("{}", fmt::join(names, ", "));
}

// known: how each trait is given.
template <typename Traits>
Traits with_traits(Traits traits, const std::vector<std::string>& changes,
                   const std::string& known) {
  for (const std::string& change : changes)
    if (!set_trait(traits, change))
      throw Error(Fault::kUsage, "This firmware has no trait " + change, "Give " + known + ".");
  return traits;
}

std::string marlin_traits() {
  return "NAME=on or NAME=off of " + joined(simulated::marlin_trait_names()) +
         "; or NAME=N, where it happens with the N-th line, of " +
         joined(simulated::marlin_line_trait_names());
}

std::string replicator_traits() {
  return "NAME=on or NAME=off of " + joined(simulated::replicator_trait_names());
}

// What the dialect usually has, unless another was asked for.
std::string firmware_of(const Arguments& arguments, Dialect dialect) {
  const std::vector<std::string> known = dialect == Dialect::kS3g
                                             ? std::vector<std::string>{"sailfish"}
                                             : std::vector<std::string>{"marlin-2.1", "marlin-1.1"};
  if (arguments.firmware.empty()) return known[0];
  if (std::find(known.begin(), known.end(), arguments.firmware) != known.end())
    return arguments.firmware;
  throw Error(Fault::kUsage,
              "A machine of this profile cannot have the firmware " + arguments.firmware,
              "Choose one of " + joined(known) + ".");
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
  const std::string firmware = firmware_of(arguments, profile.dialect);
  if (profile.dialect == Dialect::kS3g) {
    const auto traits =
        with_traits(simulated::ReplicatorTraits(), arguments.traits, replicator_traits());
    return run_simulated_replicator(options, traits, listening, interrupted());
  }
  const auto usual = firmware == "marlin-1.1" ? simulated::marlin_1_1() : simulated::MarlinTraits();
  const auto traits = with_traits(usual, arguments.traits, marlin_traits());
  run_simulated_marlin(options, traits, listening, interrupted());
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
  verb->add_option("--record", arguments->record, "A file for every executed command, one a line")
      ->type_name("FILE");
  verb->add_option("--firmware", arguments->firmware,
                   "sailfish; or marlin-2.1 (the usual one of the dialect gcode) or marlin-1.1");
  verb->add_option("--trait", arguments->traits,
                   "One way in which the firmware differs: " + marlin_traits() + "; for sailfish " +
                       replicator_traits())
      ->allow_extra_args(false);
  verb->add_flag("--json", arguments->json, "The first line as JSON");
  verb->callback([arguments] { simulate(*arguments); });
}

}  // namespace packmerger::cli
