#include "daemon/settings/config_sections.h"

#include <algorithm>
#include <limits>

#include "base/error.h"
#include "base/files.h"
#include "daemon/settings/workers.h"

namespace packmerger {
namespace {

constexpr std::uint64_t kMaxPasswordBytes = 4096;

// Empty where the file cannot be read.
std::string first_line_of(const fs::path& file) {
  try {
    const std::string text = read_file(file, kMaxPasswordBytes);
    return text.substr(0, text.find_first_of("\r\n"));
  } catch (const Error&) {
    return {};
  }
}

bool is_blank_or_control(char c) { return static_cast<unsigned char>(c) <= 0x20 || c == 0x7f; }

}  // namespace

fs::path resolved(const fs::path& file, const std::string& text) {
  return (fs::absolute(file).parent_path() / text).lexically_normal();
}

void read_prepare(TableReader& reader, const fs::path& file, PrepareConfig& prepare) {
  reader.text("program", "the path of a program", [&](const std::string& text) {
    prepare.program = resolved(file, text);
    return true;
  });
  reader.number("time_s", 1, 1e6, "a number from 1 to 1000000 (s)",
                [&](double value) { prepare.time_s = value; });
  reader.integer("memory_bytes", std::int64_t{1} << 28, std::int64_t{1} << 50,
                 "an integer from 268435456 (256 MiB) to 2^50 (bytes)", [&](std::int64_t value) {
                   prepare.memory_bytes = static_cast<std::uint64_t>(value);
                 });
  reader.integer("nice", 0, 19, "an integer from 0 to 19",
                 [&](std::int64_t value) { prepare.nice = static_cast<int>(value); });
  reader.integer("workers", 1, kMostWorkers, "an integer from 1 to 64",
                 [&](std::int64_t value) { prepare.workers = static_cast<int>(value); });
  reader.integer("seed", 0, std::numeric_limits<std::int64_t>::max(), "an integer from 0 up",
                 [&](std::int64_t value) { prepare.seed = value; });
  reader.number("budget_s", 0.001, 1e6, "a number above 0 to 1000000 (s)",
                [&](double value) { prepare.budget_s = value; });
  reader.done();
}

void read_watch(TableReader& reader, WatchConfig& watch) {
  reader.number("rescan_s", 0.1, 3600, "a number from 0.1 to 3600 (s)",
                [&](double value) { watch.rescan_s = value; });
  reader.number("still_s", 0, 3600, "a number from 0 to 3600 (s)",
                [&](double value) { watch.still_s = value; });
  reader.number("give_up_s", 0, 86400, "a number from 0 to 86400 (s)",
                [&](double value) { watch.give_up_s = value; });
  reader.done();
}

void read_web(TableReader& reader, const fs::path& file, WebConfig& web) {
  reader.integer("port", 0, 65535, "an integer from 0 (no web server) to 65535",
                 [&](std::int64_t value) { web.port = static_cast<int>(value); });
  reader.text("address", "a numeric address such as 127.0.0.1 or 0.0.0.0",
              [&](const std::string& text) {
                web.address = text;
                return text.find_first_not_of("0123456789abcdefABCDEF.:") == std::string::npos;
              });
  reader.key("hosts", "a list of names", [&](const toml::node& node) {
    const toml::array* list = node.as_array();
    if (list == nullptr) return false;
    for (const toml::node& item : *list) {
      const auto text = item.value_exact<std::string>();
      if (!text) return false;
      web.hosts.push_back(*text);
    }
    return true;
  });
  reader.flag("trust_local", [&](bool value) { web.trust_local = value; });
  reader.integer("most_upload_bytes", 1 << 20, std::int64_t{1} << 40,
                 "an integer from 1048576 (1 MiB) to 2^40 (bytes)", [&](std::int64_t value) {
                   web.most_upload_bytes = static_cast<std::uint64_t>(value);
                 });
  reader.text("page", "the path of a folder", [&](const std::string& text) {
    web.page = resolved(file, text);
    return true;
  });
  reader.done();
}

void read_webhook(TableReader& reader, WebhookSettings& webhook) {
  reader.text("url", "an address that begins with http:// or https://",
              [&](const std::string& text) {
                webhook.url = text;
                return (text.starts_with("http://") || text.starts_with("https://")) &&
                       std::none_of(text.begin(), text.end(), is_blank_or_control);
              });
  reader.text("secret", "a text", [&](const std::string& text) {
    webhook.secret = text;
    return true;
  });
  reader.done();
}

void read_mqtt(TableReader& reader, const fs::path& file, MqttSettings& mqtt) {
  reader.text("broker", "HOST or HOST:PORT", [&](const std::string& text) {
    mqtt.broker = text;
    return text.find('/') == std::string::npos &&
           std::none_of(text.begin(), text.end(), is_blank_or_control);
  });
  reader.text("topic", "a topic without + and #, that neither begins nor ends with /",
              [&](const std::string& text) {
                mqtt.topic = text;
                return text.find_first_of("+#") == std::string::npos && text.front() != '/' &&
                       text.front() != '$' && text.back() != '/' && text.size() <= 1024;
              });
  reader.text("user", "a text", [&](const std::string& text) {
    mqtt.user = text;
    return true;
  });
  reader.text("password_file", "the path of a file whose first line is the password",
              [&](const std::string& text) {
                mqtt.password = first_line_of(resolved(file, text));
                return !mqtt.password.empty();
              });
  reader.flag("tls", [&](bool value) { mqtt.tls = value; });
  reader.text("ca_file", "the path of a file of certificates (PEM)", [&](const std::string& text) {
    mqtt.ca_file = resolved(file, text).string();
    return true;
  });
  reader.done();
}

}  // namespace packmerger
