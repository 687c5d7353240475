// How the job manager finds the printer for a model that was dropped for any of them.
#include <algorithm>

#include "base/files.h"
#include "base/json_values.h"
#include "base/names.h"
#include "daemon/jobs/choose_printer.h"
#include "daemon/jobs/job_manager.h"
#include "daemon/settings/model_options.h"

namespace packmerger {
namespace {

std::vector<std::string> compare_command(const DaemonConfig& config, const PrinterConfig& printer,
                                         const JobRecord& job, const ModelOptions& options) {
  std::vector<std::string> argv = {config.prepare.program.string(),
                                   "compare",
                                   job.input,
                                   "--profile",
                                   printer.profile,
                                   "--json"};
  ModelOptions compared = options;
  compared.variant.reset();  // compare knows all of them
  const std::vector<std::string> arguments = arguments_of(compared);
  argv.insert(argv.end(), arguments.begin(), arguments.end());
  return argv;
}

bool is_being_prepared(JobState state) {
  return state == JobState::kClaiming || state == JobState::kReceived ||
         state == JobState::kPreparing;
}

}  // namespace

// For how long the printer is busy with what it prints and with what is printed there before a new
// job that takes like_s there. How long those take that are still being prepared, nobody knows yet:
// as long as the new one.
double JobManager::busy_for_s(const PrinterConfig& printer, std::int64_t new_job,
                              double like_s) const {
  double sum_s = 0;
  for (const auto& [id, job] : store_.open_jobs()) {
    if (job.printer != printer.name || job.held || has_ended(job.state)) continue;
    const double left_s = std::max(0.0, job.predicted_s - job.printed_s);
    const bool is_before = id < new_job || job.turn > 0 || job.state == JobState::kPreparing;
    if (is_being_prepared(job.state) && is_before && id != new_job) sum_s += like_s;
    if (job.state == JobState::kReady || job.state == JobState::kApproved) sum_s += left_s;
    if (job.state != JobState::kSending) continue;
    const LiveJob* running = live(id);
    const PrintReport print = running != nullptr ? running->print : PrintReport{};
    const bool is_last = job.next_tray >= job.trays;
    sum_s +=
        is_last && print.remaining_s ? *print.remaining_s : std::max(0.0, left_s - print.elapsed_s);
  }
  return sum_s;
}

std::string JobManager::trouble_at(const PrinterConfig& printer) const {
  if (store_.printer(printer.name).paused) return "paused";
  return connected(printer).value_or(true) ? "" : "not connected";
}

void JobManager::start_comparing(JobRecord job, const PrinterConfig& wish) {
  PrepareOrder order;
  order.job = job.id;
  order.input = job.input;
  order.out = job_path(job.id) / "compared";
  order.limits = config_.prepare;
  try {
    check_takes(wish, job.name);
    for (const PrinterConfig& printer : config_.printers)
      if (!printer.is_auto()) {
        const ModelOptions options = model_options(printer, &wish, job);
        order.compare.push_back({printer.name, compare_command(config_, printer, job, options),
                                 options.variant.value_or("packed")});
      }
  } catch (const Error& error) {
    return end(job, JobEventKind::kUnpreparable, printable(error.what()), error.hint());
  }
  steps_.apply(job, JobEventKind::kCompareBegins);
  store_.save(job, "comparing the printers");
  preparing_[job.id] = Preparer::kWorker;
  order.cancel = live_[job.id].cancel_prepare = std::make_shared<std::atomic<bool>>(false);
  queues_.workers.push(std::move(order));
  say(job, "comparing the printers");
}

void JobManager::on(const Compared& event) {
  let_worker_go(event.job);
  std::optional<JobRecord> job = store_.find(event.job);
  if (!job || job->state != JobState::kPreparing) return;
  const PrinterConfig* wish = config_.printer(job->printer);
  if (wish == nullptr || !wish->is_auto()) return;  // its settings are gone meanwhile
  std::vector<PrinterOffer> offers;
  for (const ComparedPrinter& compared : event.printers) {
    const PrinterConfig* printer = config_.printer(compared.printer);
    if (printer == nullptr) continue;
    PrinterOffer offer;
    offer.printer = printer->name;
    offer.profile = printer->abilities.id;
    offer.trouble = trouble_at(*printer);
    offer.why_not = printable(compared.failure);
    if (offer.fits()) take_estimates(offer, compared.estimates, compared.variant);
    offer.waits_s = busy_for_s(*printer, event.job, offer.time_s);
    offers.push_back(std::move(offer));
  }
  propose(std::move(*job), *wish, offers);
}

void JobManager::propose(JobRecord job, const PrinterConfig& wish,
                         const std::vector<PrinterOffer>& offers) {
  const Prefer prefer = wish.prefer.value_or(Prefer::kCheapest);
  const std::optional<std::size_t> best = best_offer(offers, prefer);
  job.choice = json_text(choice_view(offers, prefer, best));
  if (!best)
    return end(job, JobEventKind::kFitsNowhere,
               "It can be printed by none of the printers: " + reasons_of(offers),
               "Scale it down, or add a printer that it fits.");
  steps_.apply(job, JobEventKind::kProposed);
  job.chosen_by = wish.name;
  job.printer = offers[*best].printer;
  const std::string note = "proposed for " + job.printer + ", the " +
                           std::string(prefer_name(prefer)) + " of " +
                           std::to_string(offers.size());
  store_.save(job, note);
  say(job, note);
}

}  // namespace packmerger
