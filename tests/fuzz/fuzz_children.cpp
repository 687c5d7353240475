// What the daemon reads from its children (the report of a job, a comparison, progress, last words)
// and from the notes beside a print is read or refused with an Error, and its job ends; the daemon
// goes on.
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "base/error.h"
#include "base/files.h"
#include "daemon/jobs/job_manager.h"
#include "daemon/local/api.h"
#include "daemon/workers/worker.h"
#include "delivery/child_json.h"
#include "delivery/job_folder.h"
#include "delivery/progress_file.h"
#include "fuzz/scratch.h"

namespace {

using namespace packmerger;
using fuzz::folder;
using fuzz::put;

// A daemon without threads, with one entry that compares and one job that is being compared.
struct Office {
  Office() {
    PrinterConfig maker;
    maker.name = "maker";
    maker.profile = "marlin";
    maker.folder = folder() / "drop";
    maker.port = "/dev/null";
    PrinterConfig any = maker;
    any.name = "any";
    any.profile = kAutoProfile;
    any.prefer = Prefer::kCheapest;
    any.folder = folder() / "any";
    config.state = folder() / "state";
    config.printers = {any, maker};
    fs::create_directories(config.state);
    store = std::make_unique<JobStore>(config.state / "jobs.sqlite");
    queues = std::make_unique<WorkQueues>(config);
    job_manager = std::make_unique<JobManager>(config, *store, *queues, [](const std::string&) {});
    keys = std::make_unique<KeyRing>(config.state / "keys.json");
  }

  // A job that is with the worker.
  std::int64_t preparing(const std::string& printer) const {
    JobRecord job;
    job.printer = printer;
    job.name = "a.stl";
    job.origin = (folder() / "drop" / "a.stl").string();
    job = store->add(job);
    for (const JobState state : {JobState::kReceived, JobState::kPreparing}) {
      job.state = state;
      store->save(job);
    }
    return job.id;
  }

  // The event is taken, and the job can be shown and cancelled.
  void hears(std::int64_t job, const Event& event) const {
    job_manager->handle(event);
    for (const char* verb : {"jobs.show", "jobs.cancel"}) {
      const nlohmann::json request = {{"verb", verb}, {"id", job}};
      if (!nlohmann::json::accept(answer(*job_manager, *keys, request.dump()))) std::abort();
    }
  }

  DaemonConfig config;
  std::unique_ptr<JobStore> store;
  std::unique_ptr<WorkQueues> queues;
  std::unique_ptr<JobManager> job_manager;
  std::unique_ptr<KeyRing> keys;
};

const Office& office() {
  static const Office office;
  return office;
}

template <typename Read>
void refused_or_read(const Read& read) {
  try {
    read();
  } catch (const Error& error) {
    if (error.fault() != Fault::kBadInput || error.hint().empty()) std::abort();
  }
}

void report(std::string_view text) {
  put(folder() / "job.json", text);
  refused_or_read([] {
    const PreparedJob job = read_prepared(folder());
    const std::int64_t id = office().preparing("maker");
    office().hears(id, Prepared{id, job.trays, job.estimates, job.profile, job.seed, job.variant,
                                job.predicted_s, job.predicted_by, doubt_about(job), ""});
  });
}

void comparison(std::string_view text) {
  refused_or_read([&] {
    const std::int64_t id = office().preparing("any");
    office().hears(id, Compared{id, {{"maker", "cheapest", compared_estimates(text), ""}}});
  });
}

// As if the check had overlooked something.
void unchecked(std::string_view text) {
  const std::int64_t id = office().preparing("any");
  office().hears(id, Compared{id, {{"maker", "packed", std::string(text), ""}}});
}

void last_words(std::string_view text) {
  progress_line(text);
  if (child_failure(65, 0, text).what.empty()) std::abort();
}

void told(std::string_view text) {
  put(folder() / "told", text);
  const std::optional<Told> told = read_told(folder() / "told");
  if (told && told->done > told->total) std::abort();
}

void tray_files(std::string_view text) {
  refused_or_read([&] { hash_of_tray(std::string(text), 1); });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::array kReaders = {report, comparison, unchecked, last_words, told, tray_files};
  if (size > 0)
    kReaders[data[0] % kReaders.size()]({reinterpret_cast<const char*>(data + 1), size - 1});
  return 0;
}
