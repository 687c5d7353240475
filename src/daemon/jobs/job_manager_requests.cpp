// What people ask the job manager for, of jobs.
#include <fmt/format.h>

#include <algorithm>

#include "base/names.h"
#include "base/storage/move_file.h"
#include "daemon/jobs/job_manager.h"
#include "daemon/settings/model_options.h"
#include "delivery/child_json.h"
#include "delivery/job_file.h"
#include "job/compare/advice.h"
#include "model/file_format.h"
#include "model/job_folder_names.h"

namespace packmerger {
namespace {

std::string title(const JobRecord& job) { return "Job " + std::to_string(job.id); }

[[noreturn]] void senseless(const JobRecord& job, const std::string& what,
                            const std::string& hint) {
  throw Error(Fault::kUsage, title(job) + " is " + std::string(state_name(job.state)) + what, hint);
}

// What every job of the same file and for the same printer has in common.
JobRecord like(const JobRecord& old) {
  JobRecord job;
  job.printer = old.printer;
  job.name = old.name;
  job.sha256 = old.sha256;
  job.again_of = old.id;
  job.chosen_by = old.chosen_by;
  job.choice = old.choice;
  job.wanted = old.wanted;
  job.received_s = wall_clock_s();
  return job;
}

void check_variant(const JobRecord& job, const std::string& variant) {
  if (!variant_named(variant))
    throw Error(Fault::kUsage, "There is no variant " + printable(variant),
                fmt::format("It is one of {}.", fmt::join(variant_names(), ", ")));
  if (is_program(job.name))
    throw Error(Fault::kUsage, title(job) + " is a program, printed as it is",
                "Only models are prepared in another way.");
  const std::optional<Comparison> ways = comparison_in(job.estimates);
  const Variant way = *variant_named(variant);
  if (ways && !estimate_of(*ways, way))
    throw Error(Fault::kUsage, title(job) + ": " + printable(why_not(*ways, way)),
                "packmerger jobs show tells which ways fit; packmerger jobs prepare without one "
                "compares them anew.");
}

// Nor does what somebody approved count any more. Its figures stay until there are new ones.
void forget_what_was_prepared(JobRecord& job) {
  job.trays = 0;
  job.tray_files.clear();
  job.variant.clear();
  job.cut_short = 0;
  job.approved = job.at_once = job.pays = false;
  job.reason.clear();
  job.hint.clear();
  job.doubt.clear();
}

}  // namespace

JobRecord JobManager::get(std::int64_t id) const {
  if (std::optional<JobRecord> job = store_.find(id)) return *job;
  throw Error(Fault::kNoInput, "There is no job " + std::to_string(id),
              "packmerger jobs list shows them.");
}

const PrinterConfig& JobManager::get_printer(const std::string& name) const {
  if (const PrinterConfig* printer = config_.printer(name)) return *printer;
  throw Error(Fault::kNoInput, "There is no printer " + printable(name),
              "packmerger printers list shows them.");
}

JobRecord JobManager::uploaded(const UploadedJob& upload) {
  const PrinterConfig& chosen = get_printer(upload.printer);
  const std::string name = job_file_name(upload.name);
  check_takes(chosen, name);
  if (stopping_) throw Error(Fault::kBusy, "The daemon is ending", "Try again in a moment.");
  JobRecord job = begun(chosen, chosen.folder / name, false);
  job.at_once = upload.at_once;
  job.held = upload.held;
  if (job.at_once) store_.save(job, "to be printed as soon as it is ready");
  if (job.held) store_.save(job, "to be printed when somebody approves it");
  if (take_upload(job, upload.file)) return get(job.id);
  throw Error(Fault::kBusy, "The file cannot be taken now", "Look into the daemon's messages.");
}

JobRecord JobManager::approve(std::int64_t id) {
  JobRecord job = get(id);
  const bool approves = job.state == JobState::kReady;
  if (!approves && !(job.held && !has_ended(job.state)))
    senseless(job, " and does not wait for approval",
              "packmerger jobs show tells what it waits for.");
  if (approves) {
    job.state = JobState::kApproved;
    job.approved = true;
  }
  if (job.state == JobState::kApproved) {
    job.reason.clear();
    job.at_once = false;  // a person looked at it: no order of before any more
  }
  job.held = false;
  store_.save(job, approves ? "approved" : "no longer held");
  say(job, approves ? "approved" : "no longer held");
  return job;
}

JobRecord JobManager::hold(std::int64_t id) {
  JobRecord job = get(id);
  if (has_ended(job.state)) senseless(job, "", "There is nothing to hold any more.");
  if (job.state == JobState::kSending)
    senseless(job, " and cannot be held", "Cancel it with packmerger jobs cancel instead.");
  if (job.held) return job;
  job.held = true;
  store_.save(job, "held");
  say(job, "held");
  return job;
}

JobRecord JobManager::put_first(std::int64_t id) {
  JobRecord job = get(id);
  if (has_ended(job.state)) senseless(job, "", "packmerger jobs again has it printed once more.");
  if (job.state == JobState::kSending) senseless(job, "", "It waits for nothing any more.");
  std::int64_t most = 0;
  for (const auto& [other, record] : store_.open_jobs())
    if (other != id) most = std::max(most, record.turn);
  if (job.turn > most) return job;
  job.turn = most + 1;
  store_.save(job, "goes before all others that wait");
  say(job, "goes before all others that wait");
  return job;
}

JobRecord JobManager::cancel(std::int64_t id) {
  JobRecord job = get(id);
  if (has_ended(job.state)) senseless(job, "", "There is nothing to cancel any more.");
  if (job.state == JobState::kClaiming)
    throw Error(Fault::kBusy, title(job) + " is just being taken", "Try again in a moment.");
  const LiveJob* running = live(id);
  if (job.state == JobState::kSending) {
    // the print first: a disk that is full keeps nobody from ending it
    if (running != nullptr && running->control) running->control->cancel();
    job.reason = "cancelling";  // for the next daemon, should this one die
    store_.save(job, job.reason);
    say(job, "cancelling");
    return job;
  }
  end(job, JobState::kCancelled, "cancelled", "Drop the file again to print it after all.");
  if (running != nullptr && running->cancel_prepare) *running->cancel_prepare = true;
  return job;
}

bool JobManager::has_program(const JobRecord& ended) const {
  std::error_code ignored;
  return ended.trays > 0 && !cleaner_.is_gone(ended) &&
         fs::exists(fs::path(ended.folder) / kReportFile, ignored);
}

JobRecord JobManager::again_of(const JobRecord& ended) const {
  JobRecord job = like(ended);
  job.state = ended.approved ? JobState::kApproved : JobState::kReady;
  job.approved = job.at_once = ended.approved;
  job.folder = ended.folder;
  job.trays = ended.trays;
  job.estimates = ended.estimates;
  job.profile = ended.profile;
  job.seed = ended.seed;
  job.variant = ended.variant;
  job.tray_files = ended.tray_files;
  job.predicted_s = ended.predicted_s;
  job.predicted_by = ended.predicted_by;
  job.pays = ended.pays;
  job.doubt = ended.doubt;
  return job;
}

JobRecord JobManager::again(std::int64_t id) {
  const JobRecord old = get(id);
  if (!has_ended(old.state))
    senseless(old, " and has not ended", "Wait for its end, or cancel it first.");
  get_printer(old.printer);
  if (has_program(old)) return print_again(old);
  return prepare_again(old);
}

// The job whose file lies below done/ or failed/: one that printed another's program has none.
JobRecord JobManager::with_file(const JobRecord& old) const {
  JobRecord job = old;
  while (job.filed.empty() && job.again_of != 0) job = get(job.again_of);
  if (job.filing_done) return job;  // whether it is still there, its folder worker finds out
  if (!job.input.empty())
    throw Error(Fault::kBusy, "The model of job " + std::to_string(job.id) + " is just being filed",
                "Try again in a moment.");
  throw Error(
      Fault::kNoInput,
      "Neither the program nor the model of job " + std::to_string(old.id) + " is there any more",
      "Drop the model into the watched folder again.");
}

JobRecord JobManager::prepare(std::int64_t id, const std::string& variant) {
  JobRecord job = get(id);
  get_printer(job.printer);
  check_variant(job, variant);
  if (has_ended(job.state)) return prepare_again(job, variant);
  const bool waits = job.state == JobState::kReady || job.state == JobState::kReceived ||
                     (job.state == JobState::kApproved && job.next_tray == 1);
  if (!waits)
    senseless(job, " and cannot be prepared in another way now",
              "Wait until it is ready, or cancel it and prepare it again.");
  if (job.input.empty()) {  // it was to print the program of another job
    const JobRecord anew = prepare_again(job, variant);
    end(job, JobState::kCancelled,
        "prepared " + variant + " instead, as job " + std::to_string(anew.id), "");
    return anew;
  }
  const std::string note =
      "to be prepared " + variant + (job.approved || job.at_once ? ", and no longer approved" : "");
  job.state = JobState::kReceived;
  job.wanted = variant;
  forget_what_was_prepared(job);
  forget_tries(job);
  forget_trouble(id);
  store_.save(job, note);
  say(job, note);
  return job;
}

JobRecord JobManager::remove(std::int64_t id) {
  const JobRecord job = get(id);
  cleaner_.remove(job);
  say(job, "its folder is being deleted");
  return job;
}

// Recorded as ready first: a daemon that dies here leaves a job that asks.
JobRecord JobManager::print_again(const JobRecord& old) {
  const JobRecord wanted = again_of(old);
  JobRecord job = wanted;
  job.state = JobState::kReady;
  job = store_.add(job);
  job.state = wanted.state;
  if (!job.approved) job.reason = job.doubt;
  store_.save(job, "the program of job " + std::to_string(old.id) + " again" +
                       (job.approved ? "" : ", which nobody had approved"));
  say(job, "job " + std::to_string(old.id) + " again");
  return job;
}

JobRecord JobManager::prepare_again(const JobRecord& old, const std::string& wanted) {
  const JobRecord file = with_file(old);
  JobRecord job = like(old);
  job.origin = file.origin;
  job.by_copy = true;
  if (!wanted.empty()) job.wanted = wanted;
  job.held = old.held && !has_ended(old.state);
  job = store_.add(job);
  job.input = (job_path(job.id) / "input" / job.name).string();
  store_.save(job, "the file of job " + std::to_string(old.id) + " again");
  live_[job.id].with_folder_worker = true;
  folder_queue_of(job).push(FetchOrder{job.id, file.filed, job.input, true, true});
  say(job, "job " + std::to_string(old.id) + " again");
  return job;
}

}  // namespace packmerger
