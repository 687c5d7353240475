// The daemon's settings: one TOML file. docs/DAEMON.md lists every key.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "delivery/way.h"
#include "model/printer.h"
#include "notify/notice.h"

namespace packmerger {

enum class Approve { kAsk, kAuto };
enum class Prefer { kCheapest, kSoonest };  // of the printers that a model fits

// The profile of an entry that stands for all printers: one of them is proposed for each model.
inline constexpr std::string_view kAutoProfile = "auto";

// Limits and choices of the child process that prepares a job.
struct PrepareConfig {
  std::filesystem::path program;  // packmerger beside the daemon unless configured
  double time_s = 3600;           // longest a job may take
  std::uint64_t memory_bytes = std::uint64_t{8} << 30;  // of address space, for each process
  int nice = 10;
  std::optional<int> workers;  // models that are prepared at a time; not set: as many as suit the
                               // machine (workers.h)
  std::int64_t seed = 1;
  std::optional<double> budget_s;  // packmerger prepare --budget
};

// When a dropped file counts as whole.
struct WatchConfig {
  double rescan_s = 5;    // how often a folder is read again although nothing was reported
  double still_s = 1;     // a file must not have changed for so long
  double give_up_s = 60;  // a file that looks cut short is taken after so long, and refused then

  bool operator==(const WatchConfig&) const = default;
};

// The web server. Off until it has a port.
struct WebConfig {
  int port = 0;                       // 0: no web server
  std::string address = "127.0.0.1";  // numeric
  std::vector<std::string> hosts;     // names by which browsers reach it
  // Whether whoever asks from this machine may read without a key. Not set: as it was before this
  // could be said, yes, with a warning.
  std::optional<bool> trust_local;
  std::uint64_t most_upload_bytes = std::uint64_t{1} << 30;
  std::filesystem::path page;  // the built page's folder; it may be missing

  bool operator==(const WebConfig&) const = default;
};

// How models are prepared: the options of packmerger prepare. What is not there is left to it.
struct ModelOptions {
  std::optional<std::string> units;
  std::optional<double> size_mm;  // not together with scale
  std::optional<double> scale;
  std::optional<std::int64_t> copies;
  std::optional<std::string> variant;
  std::optional<bool> split;
  std::optional<bool> hollow;
  std::optional<std::int64_t> seed;
  std::optional<double> budget_s;
  std::vector<std::string> set;  // "key=value" of the profile

  bool operator==(const ModelOptions&) const = default;
};

struct PrinterConfig {
  std::string name;
  std::string profile;                   // an id, the absolute path of a TOML file, or "auto"
  Profile abilities;                     // that profile, as it read at the start
  std::filesystem::path folder;          // the watched folder
  std::string port;                      // unless jobs are handed over
  std::filesystem::path handoff_folder;  // where they are
  Approve approve = Approve::kAsk;
  std::optional<Prefer> prefer;  // with profile "auto", and only there
  bool simulated = false;        // no bed has to be cleared
  ModelOptions options;          // of every model for this printer

  // Whether it is no printer but stands for all that are: it is sent nothing.
  bool is_auto() const { return profile == kAutoProfile; }
  bool hands_over() const { return way_of(abilities).hands_over; }
  bool has_bed() const { return !simulated && way_of(abilities).has_bed; }
};

struct DaemonConfig {
  std::filesystem::path state;  // folder
  std::filesystem::path socket;
  unsigned socket_mode = 0600;
  PrepareConfig prepare;
  WatchConfig watch;
  WebConfig web;
  std::vector<WebhookSettings> webhooks;
  MqttSettings mqtt;
  int keep_days = 90;                   // the folder of a job that ended; 0: for ever
  int keep_jobs = 1000;                 // of those that ended last; 0: all
  double retry_s = 30;                  // between attempts to reach a printer, or to file a model
  std::vector<PrinterConfig> printers;  // by name

  const PrinterConfig* printer(const std::string& name) const;
};

// Relative paths are taken from the file's own folder. Throws Error{kBadProfile} with file, line
// and what was expected, Error{kNoInput} when there is no such file.
DaemonConfig read_config(const std::filesystem::path& file);

// One key as docs/DAEMON.md shows it; tables are written as in the file ("prepare.time_s",
// "printer.NAME.port").
struct DaemonKey {
  std::string name;
  std::string expected;  // type and range
};
std::vector<DaemonKey> daemon_keys();

}  // namespace packmerger
