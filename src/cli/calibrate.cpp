// packmerger calibrate PROFILE: from finished prints to the constants of this machine.
#include <fmt/format.h>

#include <algorithm>
#include <ctime>
#include <map>
#include <memory>

#include "base/files.h"
#include "cli/calibration_report.h"
#include "cli/daemon_verb.h"
#include "cli/late_stop.h"
#include "cli/measured_prints.h"
#include "cli/stated_prints.h"
#include "cli/verb.h"
#include "job/calibrate/calibrate.h"
#include "model/profile/derived_profile.h"
#include "model/profile/profile_keys.h"

namespace packmerger::cli {

namespace {

using nlohmann::json;

struct Arguments {
  DaemonArguments daemon;
  std::string profile;
  std::vector<std::string> prints;
  std::map<std::string, std::vector<std::string>> fields;  // by stated_fields()
  std::vector<std::string> tables;
  bool ask_daemon = false;
  std::string printer;
  std::string out;
  bool force = false;
};

// --print begins a group, and what follows it up to the next one belongs to it.
std::vector<StatedPrint> typed_prints(const CLI::App& verb, const Arguments& arguments,
                                      const Profile& profile) {
  std::vector<StatedPrint> prints;
  std::map<std::string, std::size_t> taken;  // of each option's values
  std::map<std::string, std::string> told;   // of the last print
  for (const CLI::Option* option : verb.parse_order()) {
    const std::string name = option->get_name();
    if (name == "--print") {
      const std::string& path = arguments.prints.at(taken[name]++);
      prints.emplace_back().name = path;
      prints.back().path = path;
      told.clear();
      continue;
    }
    const auto field = arguments.fields.find(name.substr(std::min<std::size_t>(2, name.size())));
    if (field == arguments.fields.end()) continue;
    const std::string& text = field->second.at(taken[name]++);
    if (prints.empty())
      throw Error(Fault::kUsage, name + " " + text + " belongs to no print",
                  "Give --print FOLDER first, and what it took after it.");
    if (!told.emplace(name, text).second)
      throw Error(Fault::kUsage, fmt::format("{} is given twice for {}", name, prints.back().name),
                  "Begin each print with a --print of its own.");
    state(prints.back(), field->first, text, profile, Fault::kUsage, name);
  }
  return prints;
}

std::vector<StatedPrint> all_prints(const CLI::App& verb, const Arguments& arguments,
                                    const Profile& profile, Warnings& warnings) {
  std::vector<StatedPrint> prints = typed_prints(verb, arguments, profile);
  for (const std::string& table : arguments.tables)
    for (StatedPrint& print : read_stated_prints(table, profile))
      prints.push_back(std::move(print));
  if (!prints.empty() && !arguments.ask_daemon && arguments.printer.empty()) return prints;
  std::vector<StatedPrint> seen =
      prints_of_daemon(profile, arguments.daemon, arguments.printer, warnings);
  if (prints.empty() && seen.empty())
    throw Error(Fault::kBadInput,
                arguments.printer.empty()
                    ? "The daemon saw no print of profile " + profile.id + " to its end"
                    : "The daemon saw no print of " + arguments.printer + " to its end",
                "State finished prints: --print FOLDER --took 6h23m --support 110g.");
  for (StatedPrint& print : seen) prints.push_back(std::move(print));
  return prints;
}

// Before the work, so that it is not done for nothing.
void check_out(const Arguments& arguments) {
  if (arguments.out.empty()) return;
  const fs::path out(arguments.out);
  if (out.extension() != ".toml" || !is_profile_id(out.stem().string()))
    throw Error(Fault::kUsage, arguments.out + " cannot be the file of a profile",
                "Name it with letters, digits, \"-\", \"_\" and \".\" alone, ending in .toml.");
  std::error_code ignored;
  if (!arguments.force && fs::exists(fs::symlink_status(out, ignored)))
    throw Error(Fault::kCannotWrite, arguments.out + " is there already",
                "Choose another name, or replace it with --force.");
}

std::string today() {
  const std::time_t now = std::time(nullptr);
  std::tm local{};
  ::localtime_r(&now, &local);
  return fmt::format("{:04}-{:02}-{:02}", local.tm_year + 1900, local.tm_mon + 1, local.tm_mday);
}

Calibration calibration_of(const Profile& profile, const std::vector<StatedPrint>& stated,
                           Warnings warnings) {
  std::vector<CalibrationPrint> prints;
  {
    const LateStop late_stop;
    const Progress progress = terminal_progress();
    for (const StatedPrint& print : stated)
      prints.push_back(measured_print(profile, print, warnings, progress));
  }
  Calibration calibration = calibrate(profile, prints);
  calibration.warnings.insert(calibration.warnings.begin(), warnings.begin(), warnings.end());
  return calibration;
}

void run(const CLI::App& verb, const Arguments& arguments) {
  check_out(arguments);
  const Profile profile = read_profile(arguments.profile);
  Warnings warnings;
  const std::vector<StatedPrint> stated = all_prints(verb, arguments, profile, warnings);
  const Calibration calibration = calibration_of(profile, stated, std::move(warnings));
  const fs::path out =
      arguments.out.empty() ? fs::path(profile.id + "-calibrated.toml") : fs::path(arguments.out);
  const std::string toml = calibrated_toml(calibration, base_for(arguments.profile, out),
                                           stated.size(), today(), out.stem().string());
  if (!arguments.out.empty()) write_file_whole(out, toml);
  if (arguments.daemon.json) {
    json told = calibration_json(calibration);
    told["prints"] = stated.size();
    told["toml"] = toml;
    told["out"] = arguments.out.empty() ? json() : json(arguments.out);
    return print_json(told);
  }
  fmt::print("{} ({}), fitted to {} finished print{}\n\n", profile.name, profile.id, stated.size(),
             stated.size() == 1 ? "" : "s");
  print_calibration(calibration);
  for (const Warning& warning : calibration.warnings)
    fmt::print(stderr, "warning: {} ({})\n", warning.text, warning.code);
  if (arguments.out.empty())
    fmt::print("\n{}", toml);
  else
    fmt::print(stderr, "Wrote {}; use it as --profile {}\n", arguments.out, arguments.out);
}

void add_print_options(CLI::App& verb, Arguments& arguments) {
  const auto add = [&](const std::string& name, std::vector<std::string>& values,
                       const std::string& help, const std::string& type) {
    return verb.add_option(name, values, help)->type_name(type)->allow_extra_args(false);
  };
  add("--print", arguments.prints,
      "a finished print: its job folder, or the model file printed as it stands; the options below "
      "belong to the --print before them",
      "PATH");
  std::map<std::string, std::vector<std::string>>& fields = arguments.fields;
  for (const std::string& field : stated_fields()) fields[field];
  add("--took", fields["took"], "how long it printed, pauses left out: 6h23m, 6:23:00, 383min",
      "TIME");
  add("--model", fields["model"], "the model material it used: 120g, 0.12kg, 167cm3", "AMOUNT");
  add("--support", fields["support"], "the support material it used", "AMOUNT");
  add("--size", fields["size"], "of a model file: its longest side as it was printed, mm", "MM");
  add("--scale", fields["scale"], "of a model file: times the file's numbers", "FACTOR");
  add("--tray", fields["tray"], "of a job folder with several trays: that one alone", "N");
  add("--prints", arguments.tables,
      "a table of finished prints: its first line names the columns print,took,model,support,size,"
      "scale,tray",
      "FILE");
}

}  // namespace

void add_calibrate(CLI::App& program) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* verb = program.add_subcommand(
      "calibrate",
      "Fits a profile's estimates to finished prints: those stated, or those the daemon saw");
  verb->add_option("PROFILE", arguments->profile, "a profile's id or path")->required();
  add_print_options(*verb, *arguments);
  verb->add_flag(
      "--daemon", arguments->ask_daemon,
      "also the prints that the daemon saw; without any stated print it is asked anyway");
  verb->add_option("--printer", arguments->printer,
                   "of the daemon's prints those of this printer, whatever profile they had")
      ->type_name("NAME");
  CLI::Option* out =
      verb->add_option("--out", arguments->out, "the profile to write; default: it is only shown")
          ->type_name("FILE");
  verb->add_flag("--force", arguments->force, "replaces the file")->needs(out);
  add_daemon_options(*verb, arguments->daemon);
  verb->callback([verb, arguments] { run(*verb, *arguments); });
}

}  // namespace packmerger::cli
