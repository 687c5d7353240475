#include <fmt/format.h>

#include <iostream>
#include <memory>

#include <nlohmann/json.hpp>

#include "cli/verb.h"
#include "model/printer.h"

namespace packmerger::cli {
namespace {

struct Arguments {
  std::string profile;
  bool json = false;
};

const char* technology_name(const Profile& profile) {
  switch (profile.technology) {
    case Technology::kPolyjet:
      return "polyjet";
    case Technology::kPowder:
      return "powder";
    case Technology::kFdm:
      break;
  }
  return "fdm";
}

void list(bool json) {
  nlohmann::json all = nlohmann::json::array();
  for (const std::string& id : profile_ids()) {
    const Profile profile = read_profile(id);
    all.push_back({{"id", id},
                   {"name", profile.name},
                   {"technology", technology_name(profile)},
                   {"build_mm", profile.build_mm}});
    if (!json)
      fmt::print("{:<14} {:<34} {:<8} {:g} x {:g} x {:g} mm\n", id, profile.name,
                 technology_name(profile), profile.build_mm[0], profile.build_mm[1],
                 profile.build_mm[2]);
  }
  if (json) std::cout << all.dump(2) << "\n";
}

void show(const Arguments& arguments) {
  const std::string toml = profile_toml(read_profile(arguments.profile));
  if (arguments.json)
    std::cout << nlohmann::json{{"id", arguments.profile}, {"toml", toml}}.dump(2) << "\n";
  else
    std::cout << toml;
}

void check(const Arguments& arguments) {
  const Profile profile = read_profile(arguments.profile);
  if (arguments.json)
    std::cout << nlohmann::json{{"id", profile.id}, {"ok", true}}.dump(2) << "\n";
  else
    fmt::print("{} is a good profile: {}\n", arguments.profile, profile.name);
}

}  // namespace

void add_profiles(CLI::App& program) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* verb = program.add_subcommand("profiles", "Lists, shows and checks printer profiles");
  verb->require_subcommand(1);
  const auto action = [&](const char* name, const char* help) {
    CLI::App* one = verb->add_subcommand(name, help);
    one->add_flag("--json", arguments->json, "prints JSON");
    return one;
  };
  action("list", "Every profile found")->callback([arguments] { list(arguments->json); });
  CLI::App* show_one = action("show", "The whole profile as TOML, every key with its value");
  show_one->add_option("PROFILE", arguments->profile, "id or path")->required();
  show_one->callback([arguments] { show(*arguments); });
  CLI::App* check_one = action("check", "Tells whether a profile can be used");
  check_one->add_option("FILE", arguments->profile, "path of a TOML file, or an id")->required();
  check_one->callback([arguments] { check(*arguments); });
}

}  // namespace packmerger::cli
