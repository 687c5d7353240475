#include <fmt/format.h>

#include <memory>

#include "base/time/duration.h"
#include "cli/checks.h"
#include "cli/daemon_verb.h"
#include "cli/verb.h"

namespace packmerger::cli {
namespace {

using nlohmann::json;

struct Arguments {
  DaemonArguments daemon;
  std::string name;
  int choice = 0;
};

// "waiting 42 %, Change the filament (Continue, Stop)"
std::string print_text(const json& print) {
  std::string text =
      fmt::format("{} {:.0f} %", text_of(print, "stage"), 100 * print.value("fraction", 0.0));
  if (const std::string what = text_of(print, "text"); !what.empty()) text += ", " + what;
  if (const json left = print.value("remaining_s", json()); left.is_number())
    text += ", " + duration_text(left.get<double>()) + " left";
  std::string choices;
  for (const json& choice : print.value("choices", json::array()))
    choices += (choices.empty() ? "" : ", ") + plain_text(choice);
  return choices.empty() ? text : text + " (" + choices + ")";
}

// Where several kinds of estimates were corrected, the one that most prints taught.
std::string takes_text(const json& printer) {
  json best;
  for (const json& one : printer.value("corrections", json::array()))
    if (best.is_null() || one.value("prints", 0) > best.value("prints", 0)) best = one;
  return best.is_null() ? "-" : correction_text(best);
}

std::string profile_text(const json& printer) {
  const std::string prefer = text_of(printer, "prefer");
  return text_of(printer, "profile") + (prefer.empty() ? "" : " (" + prefer + ")");
}

// Daemons of before tell it in words alone.
std::string trouble_of(const json& printer) {
  std::string text;
  if (const auto troubles = printer.find("troubles"); troubles != printer.end()) {
    for (const json& trouble : *troubles) text += "; " + trouble_text(trouble);
  } else if (const std::string told = text_of(printer, "trouble"); !told.empty()) {
    text = "; " + told;
  }
  return text;
}

std::vector<std::string> row_of(const json& printer) {
  const json job = printer.value("job", json());
  std::string doing = job.is_number() ? fmt::format("job {}", job.get<std::int64_t>()) : "idle";
  const json print = printer.value("print", json());
  if (print.is_object()) doing += ": " + print_text(print);
  if (printer.value("paused", false)) doing += ", paused";
  doing += trouble_of(printer);
  const json connected = printer.value("connected", json());
  const std::string port = text_of(printer, "port");
  return {text_of(printer, "name"),
          profile_text(printer),
          text_of(printer, "approve"),
          text_of(printer, "bed"),
          connected.is_boolean() ? (connected.get<bool>() ? "yes" : "no") : "-",
          doing,
          takes_text(printer),
          port.empty() ? text_of(printer, "handoff_folder") : port,
          text_of(printer, "folder")};
}

const std::vector<std::string> kHeading = {
    "PRINTER", "PROFILE", "APPROVE", "BED", "CONNECTED", "DOES", "PRINTS TAKE", "AT", "FOLDER"};

void list(const Arguments& arguments) {
  const json printers = ask(arguments.daemon, {{"verb", "printers.list"}});
  if (arguments.daemon.json) return print_json(printers);
  std::vector<std::vector<std::string>> rows = {kHeading};
  for (const json& printer : printers) rows.push_back(row_of(printer));
  print_table(rows);
  if (printers.empty())
    fmt::print(stderr,
               "No printer is configured: add a table [printer.NAME] to the daemon's settings "
               "(man 5 packmergerd.toml), and reload it.\n");
  tell_troubles(arguments.daemon);
}

void change(const Arguments& arguments, const std::string& verb) {
  json request = {{"verb", "printers." + verb}, {"name", arguments.name}};
  if (verb == "answer") request["choice"] = arguments.choice;
  const json printer = ask(arguments.daemon, request);
  if (arguments.daemon.json) return print_json(printer);
  print_table({kHeading, row_of(printer)});
  tell_start(printer);
}

}  // namespace

void add_printers(CLI::App& program) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* verb = program.add_subcommand("printers", "The daemon's printers");
  verb->require_subcommand(1);
  const auto action = [&](const std::string& name, const std::string& help) {
    return add_daemon_verb(*verb, name, help, arguments->daemon);
  };
  action("list", "Every printer, its bed and what it does")->callback([arguments] {
    list(*arguments);
  });
  for (const auto& [name, help] :
       {std::pair{"clear",
                  "Says that the printer's bed is clear, so that the next print may start"},
        std::pair{"pause", "Pauses the print that runs there, and starts no other"},
        std::pair{"resume", "Lets the print go on, and starts prints there again"},
        std::pair{"answer", "Answers what the printer asks its user"},
        std::pair{"stop", "Stops the print at once, as an emergency stop does; it fails"}}) {
    CLI::App* one = action(name, help);
    one->add_option("NAME", arguments->name, "the printer's name")->required();
    if (name == std::string_view("answer"))
      one->add_option("CHOICE", arguments->choice, "one of its choices, counted from 0")
          ->check(whole_number(0, 99))
          ->capture_default_str();
    one->callback([arguments, name = std::string(name)] { change(*arguments, name); });
  }
}

}  // namespace packmerger::cli
