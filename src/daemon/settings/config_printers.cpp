#include "daemon/settings/config_printers.h"

#include <algorithm>
#include <set>
#include <string_view>

#include "base/error.h"
#include "base/files.h"
#include "daemon/settings/config_sections.h"
#include "daemon/settings/model_options.h"
#include "delivery/find_port.h"
#include "delivery/way.h"

namespace packmerger {
namespace {

bool is_printer_name(std::string_view text) {
  const auto fits = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
           c == '_' || c == '.';
  };
  return !text.empty() && text.size() <= 64 && text.front() != '.' &&
         std::all_of(text.begin(), text.end(), fits);
}

// An entry for all printers has none of what belongs to one of them.
void check_auto(const fs::path& file, int line, PrinterConfig& printer) {
  const std::string table = "[printer." + printer.name + "]";
  if (!printer.prefer) printer.prefer = Prefer::kCheapest;
  if (!printer.port.empty() || !printer.handoff_folder.empty() || printer.simulated)
    refuse(file, line, table + " stands for all printers: it has no port, handoff_folder or bed");
}

// Their costs have to be of one currency, and there have to be some.
void check_compared(const fs::path& file, int line, const std::vector<PrinterConfig>& printers,
                    const PrinterConfig& wish) {
  const std::string table = "[printer." + wish.name + "]";
  std::set<std::string> currencies;
  for (const PrinterConfig& printer : printers) {
    if (printer.is_auto()) continue;
    currencies.insert(printer.abilities.cost.currency);
    try {
      Profile profile = printer.abilities;
      for (const std::string& assignment : wish.options.set) set_profile_key(profile, assignment);
      check_settings(profile);
    } catch (const Error& error) {
      refuse(file, line, table + ", for " + printer.name + ": " + error.what());
    }
  }
  if (currencies.empty()) refuse(file, line, table + " compares the printers, and there is none");
  if (currencies.size() > 1 && wish.prefer == Prefer::kCheapest)
    refuse(file, line,
           table + " cannot tell the cheapest: " + *currencies.begin() + " and " +
               *currencies.rbegin() +
               " are two currencies. Set cost.currency and the prices of one, or prefer soonest");
}

// What the profile's abilities ask for.
void check_printer(const fs::path& file, int line, PrinterConfig& printer) {
  const std::string table = "[printer." + printer.name + "]";
  if (printer.profile.empty()) refuse(file, line, table + " needs the key profile");
  if (printer.options.size_mm && printer.options.scale)
    refuse(file, line, table + " cannot have both size_mm and scale");
  if (printer.is_auto()) return check_auto(file, line, printer);
  if (printer.prefer) refuse(file, line, table + " has a prefer without profile = \"auto\"");
  try {
    printer.abilities = read_profile(printer.profile);
    for (const std::string& assignment : printer.options.set)
      set_profile_key(printer.abilities, assignment);
    check_settings(printer.abilities);
  } catch (const Error& error) {
    refuse(file, line, table + ": " + error.what());
  }
  // gluing parts of a plastic thread costs more than it saves, most often
  if (printer.abilities.technology == Technology::kFdm && !printer.options.variant)
    printer.options.variant = "cheapest";
  const DeliveryWay& way = way_of(printer.abilities);
  try {
    // a port where none may be is not to be corrected, it has to go
    if (!way.hands_over) check_address(printer.port);
  } catch (const Error& error) {
    refuse(file, line, table + ": " + error.what() + ". " + error.hint());
  }
  if (const auto fault = way.fault_of_settings(printer.port, printer.handoff_folder))
    refuse(file, line, table + " " + *fault);
}

}  // namespace

void read_printer_keys(TableReader& reader, const fs::path& file, PrinterConfig& printer) {
  reader.text("profile", "a profile's id, the path of a .toml file, or \"auto\"",
              [&](const std::string& text) {
                const bool is_path = text.find('/') != std::string::npos || text.ends_with(".toml");
                printer.profile = is_path ? resolved(file, text).string() : text;
                return true;
              });
  reader.text("folder", "the path of a folder", [&](const std::string& text) {
    printer.folder = resolved(file, text);
    return true;
  });
  reader.text("port", "a device such as /dev/serial/by-id/…, usb:VID:PID:SERIAL, or tcp:HOST:PORT",
              [&](const std::string& text) {
                printer.port = text;
                return true;
              });
  reader.text("handoff_folder", "the path of a folder", [&](const std::string& text) {
    printer.handoff_folder = resolved(file, text);
    return true;
  });
  reader.text("approve", "\"auto\" or \"ask\"", [&](const std::string& text) {
    printer.approve = text == "auto" ? Approve::kAuto : Approve::kAsk;
    return text == "auto" || text == "ask";
  });
  reader.text("prefer", "\"cheapest\" or \"soonest\"", [&](const std::string& text) {
    printer.prefer = text == "soonest" ? Prefer::kSoonest : Prefer::kCheapest;
    return text == "cheapest" || text == "soonest";
  });
  reader.flag("simulated", [&](bool value) { printer.simulated = value; });
  read_printer_options(reader, printer.options);
  reader.done();
}

void read_printers(const fs::path& file, const toml::table& table, DaemonConfig& config) {
  std::set<fs::path> folders;
  std::set<std::string> ports;
  for (const auto& [key, node] : table) {
    const std::string name(key.str());
    const int line = line_of(node);
    if (!is_printer_name(name))
      refuse(file, line, "printer." + name + ": expected a name of letters, digits, - _ and .");
    if (!node.is_table()) refuse(file, line, "expected a table [printer." + name + "]");
    PrinterConfig printer;
    printer.name = name;
    printer.folder = config.state / "folders" / name;
    TableReader reader(file, node.as_table(), "printer." + name + ".", nullptr);
    read_printer_keys(reader, file, printer);
    check_printer(file, line, printer);
    if (!folders.insert(printer.folder).second)
      refuse(file, line, "[printer." + name + "] watches the folder of another printer");
    if (!printer.port.empty() && !ports.insert(printer.port).second)
      refuse(file, line, "[printer." + name + "] has the port of another printer");
    config.printers.push_back(std::move(printer));
  }
  for (const PrinterConfig& printer : config.printers)
    if (printer.is_auto())
      check_compared(file, line_of(*table.get(printer.name)), config.printers, printer);
}

}  // namespace packmerger
