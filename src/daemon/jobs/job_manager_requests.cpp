// What people ask the job manager for, of jobs.
#include <fmt/format.h>

#include <algorithm>

#include "base/files.h"
#include "base/names.h"
#include "base/time/wall_clock.h"
#include "daemon/jobs/job_manager.h"
#include "daemon/jobs/job_refusals.h"
#include "daemon/settings/model_options.h"
#include "delivery/child_json.h"
#include "delivery/job_file.h"
#include "job/compare/advice.h"
#include "model/files/file_format.h"
#include "model/files/job_folder_names.h"

namespace packmerger {
namespace {

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
  job.received_s = unix_now_s();
  return job;
}

void check_variant(const JobRecord& job, const std::string& variant) {
  if (!variant_named(variant))
    throw Error(Fault::kUsage, "There is no variant " + printable(variant),
                fmt::format("It is one of {}.", fmt::join(variant_names(), ", ")));
  if (is_program(job.name))
    throw Error(Fault::kUsage, title_of(job) + " is a program, printed as it is",
                "Only models are prepared in another way.");
  const std::optional<Comparison> ways = comparison_in(job.estimates);
  const Variant way = *variant_named(variant);
  if (ways && !estimate_of(*ways, way))
    throw Error(Fault::kUsage, title_of(job) + ": " + printable(why_not(*ways, way)),
                "packmerger jobs show tells which ways fit; packmerger jobs prepare without one "
                "compares them anew.");
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
  JobRecord job = begun(JobEventKind::kUploaded, chosen, chosen.folder / name, false);
  job.at_once = upload.at_once;
  job.held = upload.held;
  if (job.at_once) store_.save(job, "to be printed as soon as it is ready");
  if (job.held) store_.save(job, "to be printed when somebody approves it");
  if (take_upload(job, upload.file)) return get(job.id);
  throw Error(Fault::kBusy, "The file cannot be taken now", "Look into the daemon's messages.");
}

JobRecord JobManager::approve(std::int64_t id) {
  JobRecord job = get(id);
  const bool approves = is_possible(job, JobEventKind::kApprove);
  if (!approves && !(job.held && is_possible(job, JobEventKind::kRelease)))
    refuse(job, JobEventKind::kApprove);
  steps_.apply(job, approves ? JobEventKind::kApprove : JobEventKind::kRelease);
  store_.save(job, approves ? "approved" : "no longer held");
  say(job, approves ? "approved" : "no longer held");
  return job;
}

JobRecord JobManager::hold(std::int64_t id) {
  JobRecord job = get(id);
  if (!is_possible(job, JobEventKind::kHold)) refuse(job, JobEventKind::kHold);
  if (job.held) return job;
  steps_.apply(job, JobEventKind::kHold);
  store_.save(job, "held");
  say(job, "held");
  return job;
}

JobRecord JobManager::put_first(std::int64_t id) {
  JobRecord job = get(id);
  if (!is_possible(job, JobEventKind::kPutFirst)) refuse(job, JobEventKind::kPutFirst);
  std::int64_t most = 0;
  for (const auto& [other, record] : store_.open_jobs())
    if (other != id) most = std::max(most, record.turn);
  if (job.turn > most) return job;
  steps_.apply(job, JobEventKind::kPutFirst);
  job.turn = most + 1;
  store_.save(job, "goes before all others that wait");
  say(job, "goes before all others that wait");
  return job;
}

JobRecord JobManager::cancel(std::int64_t id) {
  JobRecord job = get(id);
  if (!is_possible(job, JobEventKind::kCancel)) refuse(job, JobEventKind::kCancel);
  const LiveJob* running = live(id);
  if (job.state == JobState::kSending) {
    // the print first: a disk that is full keeps nobody from ending it
    if (running != nullptr && running->control) running->control->cancel();
    steps_.apply(job, JobEventKind::kCancel);
    store_.save(job, job.reason);
    say(job, "cancelling");
    return job;
  }
  end(job, JobEventKind::kCancel, "cancelled", "Drop the file again to print it after all.");
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
  if (!has_ended(old.state)) refuse(old, JobEventKind::kFileAgain);
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
  if (!is_possible(job, JobEventKind::kPrepareOtherwise) || job.next_tray > 1)
    refuse(job, JobEventKind::kPrepareOtherwise);
  if (job.input.empty()) {  // it was to print the program of another job
    const JobRecord anew = prepare_again(job, variant);
    end(job, JobEventKind::kReplace,
        "prepared " + variant + " instead, as job " + std::to_string(anew.id), "");
    return anew;
  }
  const std::string note =
      "to be prepared " + variant + (job.approved || job.at_once ? ", and no longer approved" : "");
  steps_.apply(job, JobEventKind::kPrepareOtherwise);
  job.wanted = variant;
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
  steps_.apply(job, JobEventKind::kProgramAgain);
  job = store_.add(job);
  if (wanted.state == JobState::kApproved) steps_.apply(job, JobEventKind::kApprovedBefore);
  if (!job.approved) job.reason = job.doubt;
  store_.save(job, "the program of job " + std::to_string(old.id) + " again" +
                       (job.approved ? "" : ", which nobody had approved"));
  say(job, "job " + std::to_string(old.id) + " again");
  return job;
}

JobRecord JobManager::prepare_again(const JobRecord& old, const std::string& wanted) {
  const JobRecord file = with_file(old);
  JobRecord job = like(old);
  steps_.apply(job, JobEventKind::kFileAgain);
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
