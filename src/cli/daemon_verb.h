// What the verbs that speak to the daemon share.
#pragma once

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace packmerger::cli {

struct DaemonArguments {
  std::string socket;  // empty: the default
  bool json = false;
};

// --socket and --json.
void add_daemon_options(CLI::App& verb, DaemonArguments& arguments);

// A verb below `verb` that speaks to the daemon.
CLI::App* add_daemon_verb(CLI::App& verb, const std::string& name, const std::string& help,
                          DaemonArguments& arguments);

nlohmann::json ask(const DaemonArguments& arguments, const nlohmann::json& request);

// For what is only told beside: null where the daemon does not know the verb, because it is of an
// earlier version and goes on with its print.
nlohmann::json ask_newer(const DaemonArguments& arguments, const std::string& verb);

// JSON for programs, indented, on standard output.
void print_json(const nlohmann::json& value);

// Rows of equal length, the first one the heading; columns as wide as they need.
void print_table(const std::vector<std::vector<std::string>>& rows);

// Local time, "2026-03-01 14:05"; "-" for null.
std::string time_text(const nlohmann::json& unix_s);

// A text of the daemon's reply, control characters taken out; empty where it is none.
std::string plain_text(const nlohmann::json& value);

// A member that is a text; empty when it is not there.
std::string text_of(const nlohmann::json& object, const char* key);

// Tells the print that an action started at once, where it started one.
void tell_start(const nlohmann::json& reply);

// A trouble as the daemon tells it: "nobody answers (since 2026-03-01 14:05, 7 tries, next 14:21)".
std::string trouble_text(const nlohmann::json& trouble);

// What else the daemon cannot do now (its database, who is told of changes), on standard error;
// nothing with --json.
void tell_troubles(const DaemonArguments& arguments);

// What finished prints taught, as the daemon tells it: "1.12 times as long (1.05 to 1.20, 7
// prints)".
std::string correction_text(const nlohmann::json& correction);

}  // namespace packmerger::cli
