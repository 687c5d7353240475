// How the foreman has jobs prepared, and which it approves by itself.
#include <algorithm>

#include "daemon/foreman.h"
#include "daemon/job_file.h"
#include "daemon/job_folder.h"

namespace packmerger {
namespace {

// Of a printer's options, those that are about its profile count for a program too.
void add_profile_settings(const PrinterConfig& printer, std::vector<std::string>& argv) {
  const std::vector<std::string>& options = printer.prepare_options;
  for (std::size_t i = 0; i + 1 < options.size(); ++i)
    if (options[i] == "--set") argv.insert(argv.end(), {options[i], options[i + 1]});
}

std::vector<std::string> prepare_command(const DaemonConfig& config, const PrinterConfig& printer,
                                         const JobRecord& job) {
  std::vector<std::string> argv = {config.prepare.program.string(),
                                   "prepare",
                                   job.input,
                                   "--profile",
                                   printer.profile,
                                   "--out",
                                   job.folder,
                                   "--json"};
  if (is_program(job.name)) {
    add_profile_settings(printer, argv);
    return argv;
  }
  argv.insert(argv.end(), {"--seed", std::to_string(config.prepare.seed)});
  if (config.prepare.budget_s) {
    argv.push_back("--budget");
    argv.push_back(std::to_string(*config.prepare.budget_s));
  }
  argv.insert(argv.end(), printer.prepare_options.begin(), printer.prepare_options.end());
  return argv;
}

}  // namespace

bool Foreman::is_worker_free(const JobRecord& job) const {
  return std::none_of(preparing_.begin(), preparing_.end(), [&](std::int64_t id) {
    const std::optional<JobRecord> other = store_.find(id);
    return other && is_program(other->name) == is_program(job.name);
  });
}

void Foreman::start_preparing(JobRecord job) {
  const PrinterConfig* printer = config_.printer(job.printer);
  if (printer == nullptr || !is_worker_free(job)) return;
  ++job.attempt;
  const std::string name = job.attempt == 1 ? "job" : "job-" + std::to_string(job.attempt);
  job.folder = (job_path(job.id) / name).string();
  job.state = JobState::kPreparing;
  store_.save(job, job.attempt == 1 ? "" : "attempt " + std::to_string(job.attempt));
  preparing_.insert(job.id);
  LiveJob& live = live_[job.id];
  live.cancel_prepare = std::make_shared<std::atomic<bool>>(false);
  (is_program(job.name) ? crew_.checker : crew_.worker)
      .push({job.id, job.input, job.folder, prepare_command(config_, *printer, job),
             config_.prepare, live.cancel_prepare});
  say(job, "preparing");
}

void Foreman::approve_by_itself(JobRecord job) {
  const PrinterConfig* printer = config_.printer(job.printer);
  if (printer == nullptr || job.held || !job.pays) return;
  if (printer->approve != Approve::kAuto && !job.at_once) return;
  job.state = JobState::kApproved;
  job.reason.clear();
  std::string why = "approved by itself: it is the cheapest way";
  if (job.variant == kProgramVariant) why = "approved by itself: it is printed as it is";
  if (job.at_once) why = "approved by whoever sent it";
  store_.save(job, why);
  start_sending(job);
}

}  // namespace packmerger
