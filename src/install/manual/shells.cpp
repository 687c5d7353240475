// Completions for bash and fish, and what the shells share.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "install/manual/write.h"
#include "model/printer.h"

namespace packmerger::manual {
namespace {

constexpr const char* kMade = "# Completions of packmerger, made from the program itself.\n";

std::vector<std::string> names_of(const std::vector<Option>& options) {
  std::vector<std::string> names;
  for (const Option& option : options)
    names.insert(names.end(), option.names.begin(), option.names.end());
  return names;
}

std::vector<std::string> names_of(const std::vector<Command>& commands) {
  std::vector<std::string> names;
  for (const Command& command : commands) names.push_back(command.name());
  return names;
}

std::string setting_names() {
  std::vector<std::string> names;
  for (const ProfileKey& key : profile_keys()) names.push_back(key.name + "=");
  return joined(names, " ");
}

// The bash command that completes a value of this kind.
std::string bash_values(const Option& option) {
  if (!option.choices.empty())
    return fmt::format("_packmerger_words \"{}\"", joined(option.choices, " "));
  if (option.value == "KEY=VALUE")
    return fmt::format("_packmerger_words \"{}\"; compopt -o nospace", setting_names());
  if (option.value == "PROFILE")
    return "_packmerger_words \"$(" + lister_of("PROFILE") + ")\"; _packmerger_files";
  if (const std::string lister = lister_of(option.value); !lister.empty())
    return "_packmerger_words \"$(" + lister + ")\"";
  return is_path(option.value) ? "_packmerger_files" : ":";
}

std::string fish_values(const Option& option) {
  if (!option.choices.empty()) return fmt::format(" -f -a '{}'", joined(option.choices, " "));
  if (option.value == "KEY=VALUE") return fmt::format(" -f -a '{}'", setting_names());
  if (const std::string lister = lister_of(option.value); !lister.empty())
    return fmt::format(" {}-a '({})'", option.value == "PROFILE" ? "" : "-f ", lister);
  return is_path(option.value) ? " -F" : " -f";
}

std::string in_single_quotes(std::string text) {
  for (std::size_t at = 0; (at = text.find_first_of("'\\", at)) != std::string::npos; at += 2)
    text.insert(at, "\\");
  return text;
}

std::string fish_option(const Option& option) {
  std::string text;
  for (const std::string& name : option.names)
    text += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
  if (!option.value.empty()) text += " -r" + fish_values(option);
  return text + " -d '" + in_single_quotes(option.help) + "'";
}

}  // namespace

std::string lister_of(const std::string& value) {
  if (value == "PROFILE") return "packmerger profiles list 2>/dev/null | cut -d \" \" -f 1";
  if (value == "NAME")
    return "packmerger printers list 2>/dev/null | tail -n +2 | cut -d \" \" -f 1";
  if (value == "ID") return "packmerger jobs list 2>/dev/null | tail -n +2 | cut -d \" \" -f 1";
  return {};
}

bool is_path(const std::string& value) {
  constexpr std::array<std::string_view, 7> kPaths = {"MODEL", "FILE", "DIR",    "FOLDER",
                                                      "PATH",  "PORT", "PROFILE"};
  return std::find(kPaths.begin(), kPaths.end(), value) != kPaths.end();
}

std::string bash_completion(const Command& program) {
  std::string verbs;
  std::string values;
  std::string words;
  for (const Command* command : all_commands(program)) {
    const std::string path = joined(command->path, " ");
    if (command->path.size() > 1)
      verbs += fmt::format("      \"{}\") path=$path\" $word\" ;;\n", path);
    for (const Option& option : command->options)
      if (!option.value.empty())
        for (const std::string& name : option.names)
          values += fmt::format("    \"{} {}\") {}; return ;;\n", path, name, bash_values(option));
    std::string positional = ":";
    if (!command->positionals.empty()) positional = bash_values(command->positionals.front());
    words += fmt::format(
        "    \"{}\")\n      _packmerger_words \"{}\"\n      [[ $current == -* ]] || {{ {}; }} ;;\n",
        path,
        joined(names_of(command->commands), " ") + (command->commands.empty() ? "" : " ") +
            joined(names_of(command->options), " "),
        positional);
  }
  return std::string(kMade) + R"(
_packmerger_words() { COMPREPLY+=($(compgen -W "$1" -- "$current")); }

_packmerger_files() {
  compopt -o filenames
  local file
  while IFS= read -r file; do COMPREPLY+=("$file"); done < <(compgen -f -- "$current")
}

_packmerger() {
  local current previous path=packmerger word
  # a word with = in it is one word
  _get_comp_words_by_ref -n = -c current -p previous 2>/dev/null ||
    { current=${COMP_WORDS[COMP_CWORD]}; previous=${COMP_WORDS[COMP_CWORD - 1]}; }
  COMPREPLY=()
  for word in "${COMP_WORDS[@]:1:COMP_CWORD-1}"; do
    case "$path $word" in
)" + verbs +
         R"(    esac
  done
  case "$path $previous" in
)" + values +
         R"(  esac
  case "$path" in
)" + words +
         R"(  esac
}

complete -F _packmerger packmerger
)";
}

std::string fish_completion(const Command& program) {
  std::string text = std::string(kMade) + R"(
# Whether the verbs so far are these, and no more.
function __packmerger_is
    set -l words (commandline -opc)
    set -e words[1]
    set -l verbs (string match -v -- '-*' $words)
    test "$verbs" = "$argv"
end

# Whether the command line begins with these verbs.
function __packmerger_in
    set -l words (commandline -opc)
    set -e words[1]
    test "$words[1..$(count $argv)]" = "$argv"
end

complete -c packmerger -f
)";
  for (const Command* command : all_commands(program)) {
    const std::vector<std::string> verbs(command->path.begin() + 1, command->path.end());
    const std::string at = fmt::format("complete -c packmerger -n '__packmerger_{} {}'",
                                       command->commands.empty() ? "in" : "is", joined(verbs, " "));
    for (const Command& below : command->commands)
      text += fmt::format("{} -a {} -d '{}'\n", at, below.name(), in_single_quotes(below.help));
    for (const Option& option : command->options) text += at + fish_option(option) + "\n";
    for (const Option& positional : command->positionals)
      text += at + (is_path(positional.value) ? " -F" : "") +
              (lister_of(positional.value).empty() ? "" : fish_values(positional)) + "\n";
  }
  return text;
}

}  // namespace packmerger::manual
