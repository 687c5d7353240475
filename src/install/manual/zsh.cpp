// Completions for zsh.
#include <fmt/format.h>

#include "install/manual/write.h"

namespace packmerger::manual {
namespace {

// For a text inside single quotes, where _arguments gives brackets and colons a meaning.
std::string quoted(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '[' || c == ']' || c == ':' || c == '\\') out += '\\';
    out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  }
  return out;
}

std::string values_of(const Option& option) {
  if (!option.choices.empty()) return "(" + joined(option.choices, " ") + ")";
  const std::string files = is_path(option.value) ? "_files" : "";
  if (const std::string lister = lister_of(option.value); !lister.empty())
    return fmt::format("{{compadd -- $({}); {}}}", lister, files);
  return files.empty() ? " " : files;
}

std::string spec_of(const Option& option) {
  std::string names = option.names.front();
  if (option.names.size() > 1)
    names = "(" + joined(option.names, " ") + ")'{" + joined(option.names, ",") + "}'";
  const std::string value =
      option.value.empty() ? "" : ":" + option.value + ":" + values_of(option);
  return fmt::format("'{}{}[{}]{}'", option.repeats && !option.value.empty() ? "*" : "", names,
                     quoted(option.help), value);
}

std::string function_of(const Command& command) { return "_" + joined(command.path, "_"); }

std::string group_body(const Command& group) {
  std::string verbs;
  std::string cases;
  for (const Command& verb : group.commands) {
    verbs += fmt::format("        '{}:{}'\n", verb.name(), quoted(verb.help));
    cases += fmt::format("        {}) {} ;;\n", verb.name(), function_of(verb));
  }
  return "    '1: :->verb' '*:: :->rest'\n  case $state in\n    verb)\n      verbs=(\n" + verbs +
         "      )\n      _describe verb verbs ;;\n    rest)\n      case $line[1] in\n" + cases +
         "      esac ;;\n  esac\n";
}

}  // namespace

std::string zsh_completion(const Command& program) {
  std::string text = "#compdef packmerger\n# Made from the program itself.\n";
  for (const Command* command : all_commands(program)) {
    const bool group = !command->commands.empty();
    text += fmt::format("\n{}() {{\n", function_of(*command));
    if (group) text += "  local curcontext=$curcontext state line\n  local -a verbs\n";
    text += group ? "  _arguments -C \\\n" : "  _arguments \\\n";
    for (const Option& option : command->options) text += "    " + spec_of(option) + " \\\n";
    if (group) {
      text += group_body(*command);
    } else {
      for (const Option& each : command->positionals)
        text += fmt::format("    '{}:{}:{}' \\\n", each.repeats ? "*" : "1", each.value,
                            values_of(each));
      text += "    && return\n";
    }
    text += "}\n";
  }
  return text + "\n_packmerger \"$@\"\n";
}

}  // namespace packmerger::manual
