#include "daemon/config.h"

#include <toml++/toml.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <set>

#include "base/error.h"
#include "base/files.h"
#include "base/process.h"
#include "daemon/config_sections.h"
#include "daemon/config_table.h"
#include "daemon/find_port.h"
#include "daemon/model_options.h"

namespace packmerger {
namespace {

constexpr std::uint64_t kMaxConfigBytes = 1 << 20;
constexpr std::size_t kMaxSocketPath = 107;  // sun_path of unix(7), less its final zero

fs::path environment_path(const char* name) {
  const char* text = std::getenv(name);
  return text != nullptr ? text : "";
}

bool is_printer_name(std::string_view text) {
  const auto fits = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
           c == '_' || c == '.';
  };
  return !text.empty() && text.size() <= 64 && text.front() != '.' &&
         std::all_of(text.begin(), text.end(), fits);
}

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
  if (printer.hands_over() && printer.handoff_folder.empty())
    refuse(file, line, table + " needs the key handoff_folder: this printer takes no job by wire");
  if (printer.hands_over() && !printer.port.empty())
    refuse(file, line, table + " cannot have a port: this printer takes no job by wire");
  if (!printer.hands_over() && printer.port.empty())
    refuse(file, line, table + " needs the key port");
  try {
    check_address(printer.port);
  } catch (const Error& error) {
    refuse(file, line, table + ": " + error.what() + ". " + error.hint());
  }
  if (printer.abilities.dialect == Dialect::kUsb && !is_usb(printer.port))
    refuse(file, line,
           table + " needs a port usb:VID:PID or usb:VID:PID:SERIAL: its dialect is usb");
  if (!printer.hands_over() && !printer.handoff_folder.empty())
    refuse(file, line, table + " cannot have a handoff_folder: this printer is sent its job");
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

void read_top(TableReader& reader, const fs::path& file, DaemonConfig& config) {
  reader.text("state", "the path of a folder", [&](const std::string& text) {
    config.state = resolved(file, text);
    return true;
  });
  reader.text("socket", "a path of at most 107 bytes", [&](const std::string& text) {
    config.socket = resolved(file, text);
    return config.socket.string().size() <= kMaxSocketPath;
  });
  reader.text("socket_mode", "\"0600\" or \"0660\"", [&](const std::string& text) {
    config.socket_mode = text == "0660" ? 0660 : 0600;
    return text == "0600" || text == "0660";
  });
  reader.number("retry_s", 0.1, 86400, "a number from 0.1 to 86400 (s)",
                [&](double value) { config.retry_s = value; });
}

void read_webhooks(TableReader& top, const fs::path& file, DaemonConfig& config) {
  top.key("webhook", "tables [[webhook]]", [&](const toml::node& node) {
    const toml::array* list = node.as_array();
    if (list == nullptr) return false;
    for (const toml::node& item : *list) {
      if (!item.is_table()) return false;
      TableReader reader(file, item.as_table(), "webhook.", nullptr);
      read_webhook(reader, config.webhooks.emplace_back());
      if (config.webhooks.back().url.empty())
        refuse(file, line_of(item), "[[webhook]] needs the key url");
    }
    return true;
  });
}

toml::table parse(const fs::path& file) {
  try {
    const std::string text = read_file(file, kMaxConfigBytes);
    return toml::parse(std::string_view(text), file.string());
  } catch (const toml::parse_error& error) {
    refuse(file, std::max(1, static_cast<int>(error.source().begin.line)),
           std::string(error.description()));
  } catch (const Error& error) {
    if (error.fault() == Fault::kNoInput) throw;
    refuse(file, 1, error.what());
  }
}

// Where the page is built beside this program, or else where the package puts it.
fs::path own_page() {
  const fs::path above = program_folder().parent_path();
  const fs::path built = above / "web";
  std::error_code ignored;
  return fs::exists(built / "index.html", ignored) ? built : above / "share/packmerger/web";
}

const toml::table* table_in(const fs::path& file, const toml::table& table, const char* name) {
  const toml::node* node = table.get(name);
  if (node == nullptr) return nullptr;
  if (!node->is_table())
    refuse(file, line_of(*node), std::string("expected a table [") + name + "]");
  return node->as_table();
}

}  // namespace

const PrinterConfig* DaemonConfig::printer(const std::string& name) const {
  const auto found =
      std::find_if(printers.begin(), printers.end(),
                   [&](const PrinterConfig& printer) { return printer.name == name; });
  return found == printers.end() ? nullptr : &*found;
}

DaemonConfig read_config(const fs::path& file) {
  const toml::table table = parse(file);
  DaemonConfig config;
  config.state = default_state_folder();
  config.prepare.program = program_folder() / "packmerger";
  config.web.page = own_page();
  TableReader top(file, &table, "", nullptr);
  read_top(top, file, config);
  const auto any = [](const toml::node&) { return true; };
  for (const char* name : {"prepare", "watch", "web", "mqtt", "printer"})
    top.key(name, "a table", any);
  read_webhooks(top, file, config);
  top.done();
  if (const toml::table* prepare = table_in(file, table, "prepare")) {
    TableReader reader(file, prepare, "prepare.", nullptr);
    read_prepare(reader, file, config.prepare);
  }
  if (const toml::table* watch = table_in(file, table, "watch")) {
    TableReader reader(file, watch, "watch.", nullptr);
    read_watch(reader, config.watch);
  }
  if (const toml::table* web = table_in(file, table, "web")) {
    TableReader reader(file, web, "web.", nullptr);
    read_web(reader, file, config.web);
  }
  if (const toml::table* mqtt = table_in(file, table, "mqtt")) {
    TableReader reader(file, mqtt, "mqtt.", nullptr);
    read_mqtt(reader, file, config.mqtt);
    if (config.mqtt.broker.empty()) refuse(file, line_of(*mqtt), "[mqtt] needs the key broker");
  }
  if (config.state.empty())
    refuse(file, 1, "needs the key state: neither STATE_DIRECTORY nor HOME tells where to keep it");
  if (config.socket.empty()) {
    const fs::path runtime = environment_path("RUNTIME_DIRECTORY");
    config.socket = socket_in(runtime.is_absolute() ? runtime : config.state);
  }
  if (config.socket.string().size() > kMaxSocketPath)
    refuse(file, 1, "needs the key socket: " + config.socket.string() + " is too long for one");
  if (const toml::table* printers = table_in(file, table, "printer"))
    read_printers(file, *printers, config);
  return config;
}

fs::path default_state_folder() {
  if (const fs::path given = environment_path("STATE_DIRECTORY"); given.is_absolute()) return given;
  if (const fs::path base = environment_path("XDG_STATE_HOME"); base.is_absolute())
    return base / "packmerger";
  const fs::path home = environment_path("HOME");
  return home.is_absolute() ? home / ".local/state/packmerger" : fs::path();
}

fs::path socket_in(const fs::path& folder) { return folder / "packmergerd.sock"; }

std::vector<DaemonKey> daemon_keys() {
  const fs::path file;
  std::vector<DaemonKey> keys;
  DaemonConfig config;
  PrinterConfig printer;
  TableReader top(file, nullptr, "", &keys);
  read_top(top, file, config);
  TableReader prepare(file, nullptr, "prepare.", &keys);
  read_prepare(prepare, file, config.prepare);
  TableReader watch(file, nullptr, "watch.", &keys);
  read_watch(watch, config.watch);
  TableReader web(file, nullptr, "web.", &keys);
  read_web(web, file, config.web);
  TableReader webhook(file, nullptr, "webhook.", &keys);
  read_webhook(webhook, config.webhooks.emplace_back());
  TableReader mqtt(file, nullptr, "mqtt.", &keys);
  read_mqtt(mqtt, file, config.mqtt);
  TableReader printers(file, nullptr, "printer.NAME.", &keys);
  read_printer_keys(printers, file, printer);
  return keys;
}

}  // namespace packmerger
