// A command line as data: what completions and manual pages are written from.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace packmerger::manual {

struct Option {
  std::vector<std::string> names;  // "-h", "--help"; of a positional its one name, "MODEL"
  std::string value;               // what it takes: "PROFILE", "FLOAT"; empty for a flag
  std::vector<std::string> choices;
  std::string help;
  std::string initial;  // empty: none
  bool required = false;
  bool repeats = false;
};

struct Command {
  std::vector<std::string> path;  // {"packmerger", "jobs", "list"}
  std::string help;
  std::vector<Option> options;
  std::vector<Option> positionals;
  std::vector<Command> commands;

  const std::string& name() const { return path.back(); }
};

// The program with all its verbs.
Command command_line(const CLI::App& program, const std::string& name);

// The command itself and all below it, in order.
std::vector<const Command*> all_commands(const Command& program);

std::string joined(const std::vector<std::string>& words, const std::string& between);

}  // namespace packmerger::manual
