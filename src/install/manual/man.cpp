// The parts of manual pages that are made, as roff (man(7)).
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <sstream>
#include <stdexcept>

#include "install/manual/write.h"

namespace packmerger::manual {
namespace {

std::string roff(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else
      out += c;
  }
  const bool is_request = !out.empty() && (out.front() == '.' || out.front() == '\'');
  return is_request ? "\\&" + out : out;
}

std::string bold(const std::string& text) { return "\\fB" + roff(text) + "\\fR"; }
std::string italic(const std::string& text) { return "\\fI" + roff(text) + "\\fR"; }

std::string heading_of(const Option& option) {
  std::string text;
  for (const std::string& name : option.names) text += (text.empty() ? "" : ", ") + bold(name);
  if (!option.choices.empty())
    text += " " + italic(joined(option.choices, "|"));
  else if (!option.value.empty())
    text += " " + italic(option.value);
  return text;
}

std::string entry_of(const Option& option) {
  std::string notes;
  if (option.required) notes += " Needed.";
  if (!option.initial.empty()) notes += " Default: " + option.initial + ".";
  const std::string end = option.help.ends_with('.') ? "" : ".";
  return ".TP\n" + heading_of(option) + "\n" + roff(option.help + end + notes) + "\n";
}

std::string synopsis_of(const Command& command) {
  std::string text = ".B " + roff(joined(command.path, " ")) + "\n";
  if (!command.options.empty()) text += "[\\fIoptions\\fR]\n";
  for (const Option& each : command.positionals)
    text += italic(each.value) + (each.repeats ? " ...\n" : "\n");
  return text;
}

// A cell of a table in Markdown, without its backquotes.
std::string plain(std::string cell) {
  std::erase(cell, '`');
  const std::size_t first = cell.find_first_not_of(' ');
  if (first == std::string::npos) return {};
  return cell.substr(first, cell.find_last_not_of(' ') - first + 1);
}

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream text(line.substr(1));
  for (std::string cell; std::getline(text, cell, '|');) cells.push_back(plain(cell));
  return cells;
}

}  // namespace

std::string filled(const std::string& page, const std::string& content) {
  const std::string mark = "@OPTIONS@\n";
  const std::size_t at = page.find(mark);
  if (at == std::string::npos) throw std::runtime_error("a manual page has no @OPTIONS@");
  return page.substr(0, at) + content + page.substr(at + mark.size());
}

std::string options_as_man(const Command& command) {
  std::string text;
  for (const Option& option : command.options) text += entry_of(option);
  return text;
}

std::string verbs_as_man(const Command& program) {
  std::string text;
  for (const Command* command : all_commands(program)) {
    if (!command->commands.empty()) continue;
    const std::vector<std::string> verbs(command->path.begin() + 1, command->path.end());
    text += ".SS " + roff(joined(verbs, " ")) + "\n" + synopsis_of(*command) + ".PP\n" +
            roff(command->help) + ".\n";
    for (const Option& each : command->positionals) text += entry_of(each);
    text += options_as_man(*command);
  }
  return text;
}

std::vector<KeyRow> daemon_rows(const std::vector<DaemonKey>& keys, const std::string& docs) {
  std::map<std::string, KeyRow> table;
  std::istringstream text(docs);
  for (std::string line; std::getline(text, line);) {
    if (!line.starts_with("| `")) continue;
    const std::vector<std::string> cells = cells_of(line);
    if (cells.size() == 4) table[cells[0]] = {cells[0], cells[1], cells[2], cells[3]};
  }
  std::vector<KeyRow> rows;
  for (const DaemonKey& key : keys) {
    if (!table.contains(key.name))
      throw std::runtime_error("docs/DAEMON.md does not list the key " + key.name);
    rows.push_back(table.at(key.name));
    rows.back().takes = key.expected;
  }
  return rows;
}

std::vector<KeyRow> profile_rows(const std::vector<ProfileKey>& keys) {
  std::vector<KeyRow> rows;
  for (const ProfileKey& key : keys) {
    std::string takes = key.type;
    if (!key.range.empty()) takes += ", " + key.range;
    if (!key.unit.empty()) takes += " (" + key.unit + ")";
    const bool none = key.default_value == "\"\"" || key.default_value == "[]";
    rows.push_back({key.name, takes, none ? "none" : key.default_value, key.meaning});
  }
  return rows;
}

std::string keys_as_man(const std::vector<KeyRow>& rows) {
  std::string text;
  for (const KeyRow& row : rows) {
    const std::string end = row.meaning.ends_with('.') ? "" : ".";
    text += ".TP\n" + bold(row.name) + "\n" + roff(row.meaning + end) + "\n.br\nTakes " +
            roff(row.takes) + ". ";
    if (row.initial == "required" || row.initial.starts_with("needed"))
      text += roff("Has to be given" +
                   row.initial.substr(row.initial.find(' ') == std::string::npos
                                          ? row.initial.size()
                                          : row.initial.find(' ')) +
                   ".\n");
    else
      text += roff("Default: " + (row.initial.empty() ? "none" : row.initial) + ".\n");
  }
  return text;
}

}  // namespace packmerger::manual
