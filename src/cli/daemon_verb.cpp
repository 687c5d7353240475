#include "cli/daemon_verb.h"

#include <fmt/format.h>

#include <algorithm>
#include <ctime>

#include "base/error.h"
#include "base/names.h"
#include "job/compare/comparison_table.h"
#include "local/client.h"
#include "local/places.h"

namespace packmerger::cli {
namespace {

// Characters of a UTF-8 text, which is what a column's width counts.
std::size_t width(std::string_view text) {
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xC0) != 0x80;
  }));
}

}  // namespace

void add_daemon_options(CLI::App& verb, DaemonArguments& arguments) {
  verb.add_option(
          "--socket", arguments.socket,
          "the daemon's socket; default: $PACKMERGER_SOCKET, or the one in its state folder")
      ->type_name("PATH");
  verb.add_flag("--json", arguments.json, "prints JSON");
}

CLI::App* add_daemon_verb(CLI::App& verb, const std::string& name, const std::string& help,
                          DaemonArguments& arguments) {
  CLI::App* one = verb.add_subcommand(name, help);
  add_daemon_options(*one, arguments);
  return one;
}

nlohmann::json ask(const DaemonArguments& arguments, const nlohmann::json& request) {
  return ask_daemon(
      arguments.socket.empty() ? default_socket() : std::filesystem::path(arguments.socket),
      request);
}

nlohmann::json ask_newer(const DaemonArguments& arguments, const std::string& verb) {
  try {
    return ask(arguments, {{"verb", verb}});
  } catch (const Error& error) {
    if (error.fault() != Fault::kUsage) throw;
    return nullptr;
  }
}

void print_json(const nlohmann::json& value) {
  fmt::print("{}\n", value.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
}

void print_table(const std::vector<std::vector<std::string>>& rows) {
  std::vector<std::size_t> widths(rows.front().size());
  for (const auto& row : rows)
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], width(row[i]));
  for (const auto& row : rows) {
    std::string line;
    for (std::size_t i = 0; i < row.size(); ++i)
      line += row[i] + std::string(widths[i] - width(row[i]) + 2, ' ');
    fmt::print("{}\n", line.substr(0, line.find_last_not_of(' ') + 1));
  }
}

std::string time_text(const nlohmann::json& unix_s) {
  if (!unix_s.is_number()) return "-";
  const auto seconds = static_cast<std::time_t>(unix_s.get<double>());
  std::tm local{};
  ::localtime_r(&seconds, &local);
  return fmt::format("{:04}-{:02}-{:02} {:02}:{:02}", local.tm_year + 1900, local.tm_mon + 1,
                     local.tm_mday, local.tm_hour, local.tm_min);
}

std::string plain_text(const nlohmann::json& value) {
  return value.is_string() ? printable(value.get<std::string>()) : "";
}

std::string text_of(const nlohmann::json& object, const char* key) {
  const auto found = object.find(key);
  return found == object.end() ? "" : plain_text(*found);
}

void tell_start(const nlohmann::json& reply) {
  const nlohmann::json start = reply.value("starts", nlohmann::json());
  if (!start.is_object()) return;
  std::string text = fmt::format("Job {} ({}) starts now on {}", start.value("job", 0),
                                 text_of(start, "name"), text_of(start, "printer"));
  if (start.value("trays", 1) > 1)
    text += fmt::format(", tray {} of {}", start.value("tray", 1), start.value("trays", 1));
  if (const nlohmann::json time = start.value("time_s", nlohmann::json()); time.is_number())
    text += ", about " + spoken_time(time.get<double>());
  fmt::print(stderr, "{}.\n", text);
}

std::string trouble_text(const nlohmann::json& trouble) {
  std::string text = text_of(trouble, "what");
  text += " (since " + time_text(trouble.value("since_s", nlohmann::json()));
  if (const int tries = trouble.value("tries", 0); tries > 1)
    text += fmt::format(", {} tries", tries);
  if (const nlohmann::json next = trouble.value("next_s", nlohmann::json()); next.is_number())
    text += ", next " + time_text(next).substr(11);
  return text + ")";
}

void tell_troubles(const DaemonArguments& arguments) {
  if (arguments.json) return;
  for (const nlohmann::json& trouble : ask_newer(arguments, "troubles"))
    fmt::print(stderr, "{}: {}\n", text_of(trouble, "about"), trouble_text(trouble));
}

std::string correction_text(const nlohmann::json& correction) {
  return fmt::format("{:.2f} times as long ({:.2f} to {:.2f}, {} prints)",
                     correction.value("factor", 1.0), correction.value("low", 1.0),
                     correction.value("high", 1.0), correction.value("prints", 0));
}

}  // namespace packmerger::cli
