#include "daemon/settings/config.h"

#include <toml++/toml.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>

#include "base/error.h"
#include "base/files.h"
#include "base/process/process.h"
#include "daemon/settings/config_printers.h"
#include "daemon/settings/config_sections.h"
#include "daemon/settings/config_table.h"
#include "local/places.h"

namespace packmerger {
namespace {

constexpr std::uint64_t kMaxConfigBytes = 1 << 20;
constexpr std::size_t kMaxSocketPath = 107;  // sun_path of unix(7), less its final zero

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
  reader.integer("keep_days", 0, 36500,
                 "an integer from 0 (as long as there is room) to 36500 (days)",
                 [&](std::int64_t value) { config.keep_days = static_cast<int>(value); });
  reader.integer("keep_jobs", 0, 1000000, "an integer from 0 (all) to 1000000",
                 [&](std::int64_t value) { config.keep_jobs = static_cast<int>(value); });
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
