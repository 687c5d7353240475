// packmerger simulate PROFILE: a printer that does not exist, on a pseudo-terminal.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "cli/verb.h"
#include "delivery/way.h"
#include "firmware_io/simulated/firmwares.h"
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

// The one asked for, or what such a printer usually has.
const simulated::Firmware& firmware_of(const Arguments& arguments, const Profile& profile) {
  const std::span<const std::string_view> known = way_of(profile).simulated;
  if (known.empty())
    throw Error(
        Fault::kUsage,
        "There is nothing to simulate for " + profile.id + ": it is given documents, not programs",
        "Choose a profile whose dialect is s3g or gcode, such as replicator or marlin.");
  if (arguments.firmware.empty()) return simulated::firmware_named(known.front());
  if (std::find(known.begin(), known.end(), arguments.firmware) == known.end())
    throw Error(Fault::kUsage,
                "A machine of this profile cannot have the firmware " + arguments.firmware,
                fmt::format("Choose one of {}.", fmt::join(known, ", ")));
  return simulated::firmware_named(arguments.firmware);
}

void simulate(const Arguments& arguments) {
  const Profile profile = read_profile(arguments.profile);
  const simulated::Firmware& firmware = firmware_of(arguments, profile);
  const SimulatorOptions options{checked_speed(arguments.speed), arguments.record};
  const Progress signals = terminal_progress();  // for interrupted()
  const ListeningAt listening = [&](const std::string& path) {
    if (arguments.json)
      fmt::print("{}\n", nlohmann::json{{"port", path}, {"profile", profile.id}}.dump());
    else
      fmt::print("{}\n", path);
    std::fflush(stdout);
  };
  firmware.run(options, arguments.traits, listening, interrupted());
}

// For --firmware: "marlin-2.1 (the usual one of the dialect gcode) or marlin-1.1; sailfish".
std::string firmwares_told() {
  std::string told;
  for (const DialectRow& row : kDialects) {
    const std::span<const std::string_view> known = way_of(row.dialect).simulated;
    if (known.empty()) continue;
    if (!told.empty()) told += "; ";
    told += known.front();
    if (known.size() > 1) told += fmt::format(" (the usual one of the dialect {})", row.name);
    for (const std::string_view other : known.subspan(1)) told += fmt::format(" or {}", other);
  }
  return told;
}

// For --trait: those of each firmware once.
std::string traits_told() {
  std::string told;
  std::string before;
  for (const simulated::Firmware& firmware : simulated::firmwares()) {
    const std::string traits = firmware.traits_told();
    if (traits == before) continue;
    told += told.empty() ? traits : fmt::format("; for {} {}", firmware.name, traits);
    before = traits;
  }
  return told;
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
  verb->add_option("--firmware", arguments->firmware, firmwares_told());
  verb->add_option("--trait", arguments->traits,
                   "One way in which the firmware differs: " + traits_told())
      ->allow_extra_args(false);
  verb->add_flag("--json", arguments->json, "The first line as JSON");
  verb->callback([arguments] { simulate(*arguments); });
}

}  // namespace packmerger::cli
