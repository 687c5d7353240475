// What is told to others, and whom: settings and messages as plain values.
#pragma once

#include <functional>
#include <string>

namespace packmerger {

// One change of one thing.
struct Notice {
  std::string topic;  // below MqttSettings::topic: "printers/lab"
  std::string body;   // JSON text
};

struct WebhookSettings {
  std::string url;     // http:// or https://
  std::string secret;  // signs every message; empty: unsigned

  bool operator==(const WebhookSettings&) const = default;
};

struct MqttSettings {
  std::string broker;  // HOST or HOST:PORT; empty: none
  std::string topic = "packmerger";
  std::string user;      // empty: none
  std::string password;  // empty: none
  bool tls = false;
  std::string
      ca_file;  // with tls: who signed the broker's certificate; empty: whom the system trusts

  bool operator==(const MqttSettings&) const = default;
};

// One line for the log. Called on any thread.
using TellLine = std::function<void(const std::string&)>;

}  // namespace packmerger
