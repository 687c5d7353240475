#include "daemon/jobs/job_manager.h"

#include <algorithm>

#include "base/files.h"
#include "base/names.h"
#include "daemon/jobs/waits.h"
#include "delivery/progress_file.h"
#include "model/files/job_folder_names.h"

namespace packmerger {
namespace {

constexpr int kMostPrints = 100;  // that a correction is learned from, the newest
constexpr int kMostCutShort = 5;  // in a row, of one job

std::string tray_text(const JobRecord& job) {
  return "tray " + std::to_string(job.next_tray) + " of " + std::to_string(job.trays);
}

// A folder's name for people: the model's name and the job's number.
std::string handoff_name(const JobRecord& job) {
  const std::string number = "-" + std::to_string(job.id);
  return portable_name(first_bytes(fs::path(job.name).stem().string(), 150 - number.size()) +
                       number);
}

}  // namespace

JobManager::JobManager(const DaemonConfig& config, JobStore& store, WorkQueues& queues, Log log)
    : config_(config),
      store_(store),
      queues_(queues),
      log_(std::move(log)),
      cleaner_(config, store, steps_, queues.folders[config.state / "jobs"].orders, log_) {}

fs::path JobManager::job_path(std::int64_t id) const {
  return config_.state / "jobs" / std::to_string(id);
}

fs::path JobManager::told_file(const JobRecord& job) const {
  return job_path(job.id) / progress_file(job.next_tray);
}

void JobManager::say(const JobRecord& job, const std::string& text) const {
  log_("job " + std::to_string(job.id) + " (" + printable(job.name) + ", " + job.printer +
       "): " + printable(text));
}

const LiveJob* JobManager::live(std::int64_t id) const {
  const auto found = live_.find(id);
  return found == live_.end() ? nullptr : &found->second;
}

std::int64_t JobManager::sending_at(const std::string& printer) const {
  const auto found = sending_.find(printer);
  return found == sending_.end() ? 0 : found->second;
}

const std::optional<Correction>& JobManager::correction(const std::string& printer,
                                                        const std::string& source) const {
  const auto [found, is_new] = corrections_.try_emplace({printer, source});
  if (is_new)
    found->second = learn_correction(store_.finished_prints(printer, source, kMostPrints));
  return found->second;
}

void JobManager::end(JobRecord& job, JobEventKind event, const std::string& reason,
                     const std::string& hint, const std::string& note,
                     const PrinterRecord* printer) {
  steps_.apply(job, event);
  job.reason = reason;
  job.hint = hint;
  forget_trouble(job.id);
  store_.save(job, note.empty() ? reason : note, printer);
  say(job, std::string(state_name(job.state)) + (reason.empty() ? "" : ": " + reason));
}

void JobManager::recover() {
  std::map<std::int64_t, JobRecord> open = store_.open_jobs();  // which the store then changes
  for (auto& item : open) {
    JobRecord& job = item.second;
    try_for(job.id, [&] { recover(job); });
  }
}

void JobManager::recover(JobRecord& job) {
  if (job.state == JobState::kPreparing) {
    if (++job.cut_short >= kMostCutShort) return tried_to_death(job, "while it was being prepared");
    steps_.apply(job, JobEventKind::kDied);
    store_.save(job, "the daemon died while it was being prepared; it is prepared again");
  }
  if (job.state == JobState::kSending) recover_sending(job);
  if (job.at_once) drop_order(job);
  if (job.state == JobState::kClaiming) finish_claim(job);
}

// What kills the daemon each time would keep everybody else from being printed.
void JobManager::tried_to_death(JobRecord& job, const char* what) {
  end(job, JobEventKind::kDiedTooOften,
      "the daemon died " + std::to_string(job.cut_short) + " times in a row " + what,
      "Look into the messages of the daemon and the system for what ended it (too little memory: "
      "lower prepare.memory_bytes or prepare.workers), then drop the file again.");
}

void JobManager::recover_sending(JobRecord& job) {
  const PrinterConfig* printer = config_.printer(job.printer);
  const bool hands_over = printer != nullptr && printer->hands_over();  // twice: the same folder
  if (hands_over || has_sent_nothing(told_file(job))) {
    if (++job.cut_short >= kMostCutShort)
      return tried_to_death(
          job, hands_over ? "while it was being handed over" : "before its print began");
    const PrinterRecord record = with_bed_as_before(job, Fault::kInterrupted);
    if (!job.reason.empty())  // nothing else gives one to what is being sent
      return end(job, JobEventKind::kPrintCancelled, "cancelled before the print began", "", "",
                 &record);
    const bool was_tried = is_tried_again(job);
    steps_.apply(job, JobEventKind::kDiedBeforeTheTray);
    if (was_tried) return wait_on(job, &record);
    return store_.save(job,
                       hands_over ? "the daemon was interrupted; handing over again"
                                  : "the daemon was interrupted before the print began",
                       &record);
  }
  note_told(job);
  end(job, JobEventKind::kDied, with_told(job, "interrupted while printing"),
      "See what the printer did, clear its bed, and print again with packmerger jobs again " +
          std::to_string(job.id) + ".");
}

// Who wanted a print at once meant the printer as it stood then. What lies on it when a daemon
// starts again, after a power cut or a week, nobody has looked at.
void JobManager::drop_order(JobRecord& job) {
  const PrinterConfig* printer = config_.printer(job.printer);
  if (!is_possible(job, JobEventKind::kOrderExpired)) return;
  if (job.next_tray > 1) return;  // somebody has to clear the bed for the rest
  if (printer != nullptr && !printer->has_bed()) return;
  steps_.apply(job, JobEventKind::kOrderExpired);
  store_.save(job, "the daemon was started again: not printed by an order of before");
}

// What goes wrong with one job fails that job, and not the daemon. Only what the database could
// not be told now is thrown. False: it went wrong.
bool JobManager::try_for(std::int64_t job, const std::function<void()>& work) {
  try {
    work();
    return true;
  } catch (const Error& error) {
    if (error.fault() == Fault::kCannotWrite || error.fault() == Fault::kIo ||
        error.fault() == Fault::kBusy)
      throw;
    fail(job, error.what(), error.hint());
  } catch (const std::exception& error) {
    fail(job, error.what(), "");
  }
  return false;
}

void JobManager::fail(std::int64_t id, const std::string& why, const std::string& hint) {
  const std::string what = "It could not be gone on with: " + printable(why);
  std::optional<JobRecord> job = store_.find(id);
  if (!job) return log_(what);
  if (has_ended(job->state)) return hold_up(*job, what);
  if (const LiveJob* known = live(id); known != nullptr) {
    if (known->cancel_prepare) *known->cancel_prepare = true;
    if (known->control) known->control->cancel();
  }
  if (job->state == JobState::kClaiming) return hold_up(*job, what);
  end(*job, JobEventKind::kBroken, what,
      hint.empty() ? "Please report this as a bug, with the daemon's messages." : hint);
}

void JobManager::advance(double now_s) {
  now_s_ = now_s;
  notice_printers();
  notice_folders();
  const std::map<std::int64_t, JobRecord>& open = store_.open_jobs();  // a step changes it
  std::vector<std::int64_t> jobs;
  for (const auto& [id, job] : open)
    if (may_step(job)) jobs.push_back(id);
  std::sort(jobs.begin(), jobs.end(), [&](std::int64_t a, std::int64_t b) {
    return turn_of(open.at(a)) < turn_of(open.at(b));
  });
  for (const std::int64_t id : jobs)
    if (const auto job = open.find(id); job != open.end()) try_for(id, [&] { step(job->second); });
  drop_idle_live_jobs();
}

void JobManager::clean(double now_s) {
  if (!stopping_) cleaner_.serve(now_s);
}

std::tuple<bool, std::int64_t, std::int64_t> JobManager::turn_of(const JobRecord& job) {
  return {job.next_tray <= 1, -job.turn, job.id};
}

// Thousands may wait to be prepared, and this is asked of each at every turn of the loop.
bool JobManager::may_step(const JobRecord& job) const {
  if (job.state == JobState::kReceived || job.state == JobState::kPreparing)
    return is_free(preparer_of(job)) && !preparing_.contains(job.id) &&
           !(job.cut_short > 0 && is_suspect_preparing());
  return job.state != JobState::kSending;
}

// Of those that were being prepared when the daemon died one may be why: never two of them at the
// same time, so that it takes no other with it again and again.
bool JobManager::is_suspect_preparing() const {
  const std::map<std::int64_t, JobRecord>& open = store_.open_jobs();
  return std::any_of(preparing_.begin(), preparing_.end(), [&](const auto& item) {
    const auto job = open.find(item.first);
    return job != open.end() && job->second.cut_short > 0;
  });
}

void JobManager::drop_idle_live_jobs() {
  std::erase_if(live_, [&](const auto& item) {
    const LiveJob& live = item.second;
    const bool idle = !live.cancel_prepare && !live.control && !live.with_folder_worker;
    return idle && !store_.open_jobs().contains(item.first);
  });
}

void JobManager::step(const JobRecord& job) {
  if (has_ended(job.state)) return file_away(job);
  if (stopping_) return;
  switch (job.state) {
    case JobState::kClaiming:
      return finish_claim(job);
    case JobState::kReceived:
    case JobState::kPreparing:
      return start_preparing(job);
    case JobState::kReady:
      return approve_by_itself(job);
    case JobState::kApproved:
      return start_sending(job);
    default:
      return;
  }
}

void JobManager::start_sending(const JobRecord& approved) {
  const PrinterConfig* printer = config_.printer(approved.printer);
  if (printer == nullptr || waits_for(*this, approved) != Waits::kNothing) return;
  LiveJob& live = live_[approved.id];
  if (now_s_ < live.retry_s) return;
  JobRecord job = approved;
  PrinterRecord record = store_.printer(job.printer);
  if (printer->has_bed()) record.bed_clear = false;
  steps_.apply(job, JobEventKind::kTrayBegins);
  const bool is_first = job.tries == 0;  // what is tried again was told
  is_first ? store_.save(job, tray_text(job), &record) : store_.save_untold(job, &record);
  std::error_code untold;  // the sender tells where its file cannot be made
  fs::create_directories(job_path(job.id), untold);
  fs::remove_all(told_file(job), untold);  // of an attempt before, or nobody knows of whom
  sending_[job.printer] = job.id;
  live.control = std::make_shared<PrintControl>();
  live.print = {};
  queues_.senders.at(job.printer)
      .push({job.id, job.folder, job.next_tray, handoff_name(job), told_file(job), live.control,
             job.tray_files});
  if (is_first) say(job, "sending " + tray_text(job));
}

void JobManager::stop() {
  stopping_ = true;
  for (auto& [id, live] : live_) {
    if (live.cancel_prepare) *live.cancel_prepare = true;
    if (!live.control) continue;
    live.ended_by_stop = !live.control->cancelled();
    live.control->cancel();
  }
}

}  // namespace packmerger
