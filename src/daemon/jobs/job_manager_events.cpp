// How the job manager takes what the other threads tell.
#include <algorithm>
#include <utility>

#include "base/files.h"
#include "base/names.h"
#include "daemon/jobs/job_manager.h"
#include "delivery/progress_file.h"

namespace packmerger {
namespace {

std::string sentence(const Failure& failure) { return printable(failure.what); }

// 0: it is about none.
std::int64_t job_of(const Event& event) {
  return std::visit(
      [](const auto& each) -> std::int64_t {
        if constexpr (requires { each.job; }) return each.job;
        return 0;
      },
      event);
}

}  // namespace

void JobManager::handle(const Event& event) {
  const bool is_done =
      try_for(job_of(event), [&] { std::visit([&](const auto& each) { on(each); }, event); });
  if (is_done) return;
  // whoever had the job is done with it all the same
  if (const auto* sent = std::get_if<SendEnded>(&event)) let_sender_go(sent->job);
  if (std::holds_alternative<Prepared>(event) || std::holds_alternative<PrepareFailed>(event) ||
      std::holds_alternative<Compared>(event))
    let_worker_go(job_of(event));
  live_[job_of(event)].with_folder_worker = false;
}

void JobManager::let_worker_go(std::int64_t id) {
  live_[id].cancel_prepare.reset();
  preparing_.erase(id);
}

void JobManager::let_sender_go(std::int64_t id) {
  live_[id].control.reset();
  live_[id].print = {};
  std::erase_if(sending_, [&](const auto& item) { return item.second == id; });
}

void JobManager::on(const PrepareProgress& event) {
  if (!preparing_.contains(event.job)) return;
  live_[event.job].stage = event.stage;
  live_[event.job].fraction = event.fraction;
}

void JobManager::on(const Hashed& event) {
  std::optional<JobRecord> job = store_.find(event.job);
  if (!job || job->state != JobState::kPreparing || job->sha256 == event.sha256) return;
  std::string note;
  if (job->again_of != 0 && !job->sha256.empty())
    note = "the file was changed since job " + std::to_string(job->again_of);
  steps_.apply(*job, JobEventKind::kHashed);
  job->sha256 = event.sha256;
  const std::int64_t same = store_.same_bytes(*job);
  if (same != 0 && same != job->again_of) note = "the same bytes as job " + std::to_string(same);
  store_.save(*job, note);
  if (!note.empty()) say(*job, note);
}

void JobManager::on(const Prepared& event) {
  std::optional<JobRecord> job = store_.find(event.job);
  if (job && job->state == JobState::kPreparing) {
    steps_.apply(*job, JobEventKind::kPrepared);
    job->trays = event.trays;
    job->estimates = event.estimates;
    job->profile = event.profile;
    job->seed = event.seed;
    job->variant = event.variant;
    job->tray_files = event.tray_files;
    job->predicted_s = event.predicted_s;
    job->predicted_by = event.predicted_by;
    job->pays = event.doubt.empty();
    job->doubt = event.doubt;
    job->reason = event.doubt;
    store_.save(*job, job->reason);
    say(*job, "ready");
  }
  let_worker_go(event.job);
}

void JobManager::on(const PrepareFailed& event) {
  std::optional<JobRecord> job = store_.find(event.job);
  const bool stopped = stopping_ && event.failure.fault == Fault::kInterrupted;
  if (job && job->state == JobState::kPreparing && stopped) {
    steps_.apply(*job, JobEventKind::kStopped);  // it waits for the next daemon
    store_.save_untold(*job);
  } else if (job && job->state == JobState::kPreparing) {
    end(*job, JobEventKind::kPrepareFailed, sentence(event.failure), event.failure.hint);
  }
  let_worker_go(event.job);
}

void JobManager::on(const SendProgress& event) {
  const auto found = live_.find(event.job);
  if (found == live_.end() || !found->second.control) return;
  found->second.print = event.report;
  if (event.report.state == PrintState::kConnecting) return;
  if (has_begun(event.report)) started_after_all(event.job);
  for (const auto& [printer, job] : sending_)
    if (job == event.job) reached_[printer] = true;
}

void JobManager::on(const SendEnded& event) {
  std::optional<JobRecord> job = store_.find(event.job);
  if (!job) return;
  note_reached(*job, event);
  if (job->state == JobState::kSending) sent(*job, event);
  let_sender_go(event.job);
}

// How far the tray's print was told to go, as its sender wrote it down.
void JobManager::note_told(JobRecord& job) const {
  const Told told = read_told(told_file(job)).value_or(Told{});
  job.told = static_cast<std::int64_t>(told.done);
  job.told_total = static_cast<std::int64_t>(told.total);
}

std::string JobManager::with_told(const JobRecord& job, const std::string& reason) const {
  const PrinterConfig* printer = config_.printer(job.printer);
  if (job.told_total == 0 || printer == nullptr) return reason;
  const Told told{static_cast<std::size_t>(job.told), static_cast<std::size_t>(job.told_total)};
  return reason + ", told up to " + told_text(told, way_of(printer->abilities).unit);
}

void JobManager::sent(JobRecord job, const SendEnded& event) {
  const PrinterConfig* printer = config_.printer(job.printer);
  const bool handed_over = printer != nullptr && printer->hands_over();
  const LiveJob& live = live_[job.id];
  const bool waits = event.outcome == SendOutcome::kNotStarted ||
                     (event.outcome == SendOutcome::kCancelled && live.ended_by_stop);
  // somebody may have cancelled it while its sender told that it is to be tried again
  const bool is_wanted = !live.control || !live.control->cancelled() || live.ended_by_stop;
  const bool untouched = event.untouched || event.outcome == SendOutcome::kNotStarted;
  if (untouched) return waits && is_wanted ? not_started(job, event) : end_untouched(job, event);
  note_told(job);
  if (event.outcome == SendOutcome::kFailed)
    return end(job, JobEventKind::kPrintFailed, with_told(job, sentence(event.failure)),
               event.failure.hint);
  if (event.outcome == SendOutcome::kCancelled) {
    // a printer that did not obey, whose heaters may be on, is worth telling
    const bool obeyed = event.failure.fault == Fault::kInterrupted && event.failure.hint.empty();
    const std::string tail = obeyed ? "" : ": " + sentence(event.failure);
    if (stopping_)
      return end(job, JobEventKind::kStopped,
                 with_told(job, "the daemon was stopped while printing" + tail),
                 (obeyed ? "" : event.failure.hint + " ") +
                     "Clear the bed and print again with packmerger jobs again " +
                     std::to_string(job.id) + ".");
    return end(job, JobEventKind::kPrintCancelled,
               with_told(job, "cancelled while printing" + tail), obeyed ? "" : event.failure.hint);
  }
  job.printed_s += event.printed_s;
  job.paused_s += event.paused_s;
  corrections_.clear();
  if (handed_over) return end(job, JobEventKind::kTrayHandedOver, "", "", event.note);
  const std::string note = with_told(job, "tray " + std::to_string(job.next_tray) + " is printed");
  if (job.next_tray >= job.trays) return end(job, JobEventKind::kLastTrayPrinted, "", "", note);
  if (live.control && live.control->cancelled() && !live.ended_by_stop)  // in its last moment
    return end(job, JobEventKind::kPrintCancelled, "cancelled: " + note + ", and no further one",
               "");
  steps_.apply(job, JobEventKind::kTrayPrinted);
  store_.save(job, note);
  live_[job.id].failures = 0;
  say(job, note);
}

// Nothing of ours was printed: the bed is as clear as it was before, unless somebody else is
// printing: then there will be something on it.
PrinterRecord JobManager::with_bed_as_before(const JobRecord& job, Fault why_not_begun) const {
  const PrinterConfig* printer = config_.printer(job.printer);
  const bool was_clear = printer != nullptr && printer->has_bed() && why_not_begun != Fault::kBusy;
  PrinterRecord record = store_.printer(job.printer);
  record.bed_clear = record.bed_clear || was_clear;
  return record;
}

void JobManager::end_untouched(JobRecord job, const SendEnded& event) {
  const PrinterRecord record = with_bed_as_before(job, event.failure.fault);
  if (event.outcome == SendOutcome::kFailed)
    return end(job, JobEventKind::kPrintFailed, sentence(event.failure), event.failure.hint, "",
               &record);
  end(job, JobEventKind::kPrintCancelled, "cancelled before the print began", "", "", &record);
}

}  // namespace packmerger
