#include <fmt/format.h>

#include <memory>

#include "cli/daemon_verb.h"
#include "cli/verb.h"

namespace packmerger::cli {
namespace {

using nlohmann::json;

struct Arguments {
  DaemonArguments daemon;
  std::string name;
};

void print_keys(const Arguments& arguments, const json& keys) {
  if (arguments.daemon.json) return print_json(keys);
  if (keys.empty()) return fmt::print("There are no keys: nobody can change anything by web.\n");
  std::vector<std::vector<std::string>> rows = {{"KEY", "MADE", "MAY"}};
  for (const json& key : keys)
    rows.push_back(
        {text_of(key, "name"), time_text(key.value("made_s", json())), text_of(key, "may")});
  print_table(rows);
}

void list(const Arguments& arguments) {
  print_keys(arguments, ask(arguments.daemon, {{"verb", "keys.list"}}));
}

void revoke(const Arguments& arguments) {
  print_keys(arguments, ask(arguments.daemon, {{"verb", "keys.revoke"}, {"name", arguments.name}}));
}

void add(const Arguments& arguments) {
  const json key = ask(arguments.daemon, {{"verb", "keys.add"}, {"name", arguments.name}});
  if (arguments.daemon.json) return print_json(key);
  fmt::print("{}\n", text_of(key, "key"));
  fmt::print(stderr, "Keep it: it is shown only now. Programs send it as X-Api-Key.\n");
}

void link(const Arguments& arguments) {
  const json made = ask(arguments.daemon, {{"verb", "keys.link"}});
  if (arguments.daemon.json) return print_json(made);
  fmt::print("{}\n", text_of(made, "link"));
  fmt::print(stderr,
             "Good for one browser, within {:.0f} minutes. It may look; to change something "
             "the page asks for a key.\n",
             made.value("good_for_s", 0.0) / 60);
}

}  // namespace

void add_keys(CLI::App& program) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* verb = program.add_subcommand("keys", "Keys for the daemon's web server");
  verb->require_subcommand(1);
  const auto action = [&](const std::string& name, const std::string& help) {
    return add_daemon_verb(*verb, name, help, arguments->daemon);
  };
  const auto named = [&](CLI::App* one) {
    one->add_option("WHO", arguments->name, "whose key it is")->required();
    return one;
  };
  action("list", "Which keys there are")->callback([arguments] { list(*arguments); });
  named(action("add", "Makes a key and prints it, once"))->callback([arguments] {
    add(*arguments);
  });
  action("link", "Prints a link with which a browser may look at the page, once")
      ->callback([arguments] { link(*arguments); });
  named(action("revoke", "Makes a key worthless"))->callback([arguments] { revoke(*arguments); });
}

}  // namespace packmerger::cli
