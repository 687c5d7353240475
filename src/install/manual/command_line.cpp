#include "install/manual/command_line.h"

namespace packmerger::manual {
namespace {

// CLI11 writes "TEXT:{mm,cm,in}" for a set, and "ENUM:value in {packed->0,solid->2} OR …" for a
// map; ours are written "packed|solid".
std::vector<std::string> choices_in(const std::string& type) {
  if (type.find('|') != std::string::npos) return CLI::detail::split(type, '|');
  std::vector<std::string> choices;
  const std::size_t open = type.find('{');
  if (open == std::string::npos) return choices;
  std::string list = type.substr(open + 1, type.find('}') - open - 1);
  for (const std::string& item : CLI::detail::split(list, ','))
    choices.push_back(item.substr(0, item.find("->")));
  return choices;
}

Option option_of(const CLI::Option& given) {
  Option option;
  if (given.get_positional()) {
    option.names = {given.get_name()};
  } else {
    for (const std::string& name : given.get_snames()) option.names.push_back("-" + name);
    for (const std::string& name : given.get_lnames()) option.names.push_back("--" + name);
  }
  const std::string type = given.get_type_name();
  const bool takes_value = given.get_items_expected_max() > 0;
  option.choices = choices_in(type);
  if (takes_value) option.value = type.substr(0, type.find(':'));
  if (!option.choices.empty()) option.value = "CHOICE";
  if (given.get_positional()) option.value = option.names.front();
  option.help = given.get_description();
  option.initial = takes_value ? given.get_default_str() : "";
  option.required = given.get_required();
  option.repeats = given.get_expected_max() > 1 ||
                   given.get_multi_option_policy() == CLI::MultiOptionPolicy::TakeAll;
  return option;
}

Command command_of(const CLI::App& app, std::vector<std::string> path) {
  Command command;
  command.path = std::move(path);
  command.help = app.get_description();
  for (const CLI::Option* option : app.get_options())
    (option->get_positional() ? command.positionals : command.options)
        .push_back(option_of(*option));
  for (const CLI::App* verb : app.get_subcommands({})) {
    std::vector<std::string> below = command.path;
    below.push_back(verb->get_name());
    command.commands.push_back(command_of(*verb, std::move(below)));
  }
  return command;
}

}  // namespace

Command command_line(const CLI::App& program, const std::string& name) {
  return command_of(program, {name});
}

std::vector<const Command*> all_commands(const Command& program) {
  std::vector<const Command*> all = {&program};
  for (const Command& verb : program.commands) {
    const std::vector<const Command*> below = all_commands(verb);
    all.insert(all.end(), below.begin(), below.end());
  }
  return all;
}

std::string joined(const std::vector<std::string>& words, const std::string& between) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : between) + word;
  return text;
}

}  // namespace packmerger::manual
