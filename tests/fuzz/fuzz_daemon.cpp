// What the daemon reads from outside, job folders, its configuration and requests at its socket, is
// read or refused with an Error that says what to do.
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "base/error.h"
#include "base/files.h"
#include "daemon/jobs/job_manager.h"
#include "daemon/local/api.h"
#include "daemon/settings/config.h"
#include "delivery/job_folder.h"
#include "fuzz/scratch.h"

namespace {

using namespace packmerger;
using fuzz::folder;
using fuzz::put;

template <typename Read>
void refused_or_read(Fault expected, const Read& read) {
  try {
    read();
  } catch (const Error& error) {
    // a profile that is named may be missing
    const bool told = error.fault() == expected || error.fault() == Fault::kNoInput;
    if (!told || error.hint().empty()) std::abort();
  }
}

void job_report(std::string_view text) {
  put(folder() / "job.json", text);
  refused_or_read(Fault::kBadInput, [] { doubt_about(read_prepared(folder())); });
}

void job_profile(std::string_view text) {
  put(folder() / "profile.toml", text);
  refused_or_read(Fault::kBadProfile, [] { read_prepared_profile(folder()); });
}

void configuration(std::string_view text) {
  const fs::path file = folder() / "packmergerd.toml";
  put(file, text);
  refused_or_read(Fault::kBadProfile, [&] { read_config(file); });
}

// A daemon without threads, with one printer and one job.
struct Office {
  Office() {
    PrinterConfig printer;
    printer.name = "maker";
    printer.profile = "marlin";
    printer.folder = folder() / "drop";
    printer.port = "/dev/null";
    config.state = folder() / "state";
    config.printers = {printer};
    fs::create_directories(config.state);
    fs::create_directories(printer.folder);
    store = std::make_unique<JobStore>(config.state / "jobs.sqlite");
    queues = std::make_unique<WorkQueues>(config);
    job_manager = std::make_unique<JobManager>(config, *store, *queues, [](const std::string&) {});
    keys = std::make_unique<KeyRing>(config.state / "keys.json");
    job_manager->recover();
    std::ofstream(printer.folder / "a.stl") << "a model";
    job_manager->handle(Arrived{printer.name, printer.folder / "a.stl", false});
    job_manager->handle(Claimed{1, ClaimOutcome::kGone, {}});
  }

  DaemonConfig config;
  std::unique_ptr<JobStore> store;
  std::unique_ptr<WorkQueues> queues;
  std::unique_ptr<JobManager> job_manager;
  std::unique_ptr<KeyRing> keys;
};

void request(std::string_view text) {
  static const Office office;
  const auto reply = nlohmann::json::parse(answer(*office.job_manager, *office.keys, text));
  if (!reply.at("ok").get<bool>() && reply.at("error").at("hint").get<std::string>().empty())
    std::abort();
}

// A request whose verb is known, so that what it needs is read.
void known_request(std::string_view text) {
  constexpr std::array<std::string_view, 11> kVerbs = {
      "jobs.list",      "jobs.show",       "jobs.approve",  "jobs.hold",
      "jobs.first",     "jobs.cancel",     "printers.list", "printers.clear",
      "printers.pause", "printers.answer", "printers.stop"};
  if (text.empty()) return;
  const std::size_t verb = static_cast<std::uint8_t>(text[0]) % kVerbs.size();
  request("{\"verb\": \"" + std::string(kVerbs[verb]) + "\", " + std::string(text.substr(1)));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::array kReaders = {job_report, job_profile, configuration, request, known_request};
  if (size > 0)
    kReaders[data[0] % kReaders.size()]({reinterpret_cast<const char*>(data + 1), size - 1});
  return 0;
}
