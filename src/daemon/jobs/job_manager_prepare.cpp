// How the job manager has jobs prepared, and which it approves by itself.
#include <algorithm>

#include "base/names.h"
#include "daemon/intake/beside.h"
#include "daemon/jobs/job_manager.h"
#include "daemon/settings/model_options.h"
#include "daemon/settings/workers.h"
#include "delivery/job_folder.h"
#include "delivery/way.h"
#include "model/files/file_format.h"
#include "model/files/job_folder_names.h"

namespace packmerger {
namespace {

std::string folder_name(int attempt) {
  return attempt == 1 ? "job" : "job-" + std::to_string(attempt);
}

}  // namespace
void JobManager::check_takes(const PrinterConfig& printer, const std::string& name) const {
  if (!is_program(name)) return;
  if (printer.is_auto())
    throw Error(Fault::kBadInput, "A program is made for one printer",
                "Give it to that printer, and only models to " + printer.name + ".");
  way_of(printer.abilities).check_program(printer.abilities, kind_of_file(name));
}

// From the general to the particular: the daemon's settings, the printer's, those of the entry that
// the printer was chosen by, and the model's own.
ModelOptions JobManager::model_options(const PrinterConfig& printer, const PrinterConfig* wish,
                                       const JobRecord& job) const {
  ModelOptions options;
  options.seed = config_.prepare.seed;
  options.budget_s = config_.prepare.budget_s;
  options = laid_over(options, printer.options);
  if (wish != nullptr) options = laid_over(options, wish->options);
  if (job.with_settings)
    options =
        laid_over(options, read_model_settings(settings_beside(job.input), printer.abilities));
  if (!job.wanted.empty()) options.variant = job.wanted;
  return options;
}

std::vector<std::string> JobManager::prepare_command(const PrinterConfig& printer,
                                                     const JobRecord& job) const {
  std::vector<std::string> argv = {config_.prepare.program.string(),
                                   "prepare",
                                   job.input,
                                   "--profile",
                                   printer.profile,
                                   "--out",
                                   job.folder,
                                   "--json"};
  const auto add = [&](const std::vector<std::string>& arguments) {
    argv.insert(argv.end(), arguments.begin(), arguments.end());
  };
  if (is_program(job.name)) {
    if (job.with_settings)
      throw Error(Fault::kBadInput,
                  "A program is printed as it is: a settings file beside it changes nothing",
                  "Remove the settings file, and drop the program again.");
    add(profile_arguments_of(printer.options));
    return argv;
  }
  add(arguments_of(model_options(printer, config_.printer(job.chosen_by), job)));
  if (const fs::path compared = compared_before(job); !compared.empty())
    add({"--compared", compared.string()});
  return argv;
}

// Where the ways of printing this model may have been compared already: what was prepared of this
// job, or of the one that it makes again. prepare looks whether that still holds.
fs::path JobManager::compared_before(const JobRecord& job) const {
  std::vector<fs::path> folders;
  for (int attempt = job.attempt; attempt > 0; --attempt)
    folders.push_back(job_path(job.id) / folder_name(attempt));
  if (const auto old = store_.find(job.again_of); old && !old->folder.empty())
    folders.emplace_back(old->folder);
  for (const fs::path& folder : folders) {
    std::error_code ignored;
    if (fs::is_regular_file(folder / kReportFile, ignored)) return folder;
  }
  return {};
}

Preparer JobManager::preparer_of(const JobRecord& job) {
  return is_program(job.name) ? Preparer::kChecker : Preparer::kWorker;
}

bool JobManager::is_free(Preparer preparer) const {
  const auto busy = std::count_if(preparing_.begin(), preparing_.end(),
                                  [&](const auto& item) { return item.second == preparer; });
  return busy < (preparer == Preparer::kChecker ? 1 : workers_of(config_.prepare));
}

void JobManager::start_preparing(const JobRecord& waiting) {
  const PrinterConfig* printer = config_.printer(waiting.printer);
  const Preparer preparer = preparer_of(waiting);
  if (printer == nullptr || !may_step(waiting)) return;
  if (printer->is_auto()) return start_comparing(waiting, *printer);
  JobRecord job = waiting;
  std::vector<std::string> command;
  try {
    job.folder = (job_path(job.id) / folder_name(job.attempt + 1)).string();
    command = prepare_command(*printer, job);
  } catch (const Error& error) {
    job.folder.clear();
    return end(job, JobEventKind::kUnpreparable, printable(error.what()), error.hint());
  }
  steps_.apply(job, JobEventKind::kPrepareBegins);
  store_.save(job, job.attempt == 1 ? "" : "attempt " + std::to_string(job.attempt));
  preparing_[job.id] = preparer;
  PrepareOrder order;
  order.job = job.id;
  order.input = job.input;
  order.out = job.folder;
  order.argv = std::move(command);
  order.limits = config_.prepare;
  order.cancel = live_[job.id].cancel_prepare = std::make_shared<std::atomic<bool>>(false);
  (preparer == Preparer::kChecker ? queues_.checker : queues_.workers).push(std::move(order));
  say(job, "preparing");
}

bool JobManager::is_approved_by_itself(const JobRecord& ready) const {
  const PrinterConfig* printer = config_.printer(ready.printer);
  if (printer == nullptr || ready.held || !ready.pays) return false;
  if (printer->approve != Approve::kAuto && !ready.at_once) return false;
  if (ready.chosen_by.empty()) return true;
  const PrinterConfig* wish = config_.printer(ready.chosen_by);  // nobody chose this printer
  return wish != nullptr && wish->approve == Approve::kAuto;
}

void JobManager::approve_by_itself(const JobRecord& ready) {
  if (!is_approved_by_itself(ready)) return;
  JobRecord job = ready;
  steps_.apply(job, JobEventKind::kApproveByItself);
  std::string why = "approved by itself: it is the cheapest way";
  if (job.variant == kProgramVariant) why = "approved by itself: it is printed as it is";
  if (job.at_once) why = "approved by whoever sent it";
  store_.save(job, why);
  start_sending(job);
}

}  // namespace packmerger
