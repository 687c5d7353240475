// What fails is tried again, ever less often: told once, and shown until it is over.
#include "base/names.h"
#include "base/time/backoff.h"
#include "base/time/wall_clock.h"
#include "daemon/jobs/job_manager.h"
#include "daemon/jobs/waits.h"

namespace packmerger {

void JobManager::retry_later(LiveJob& live) const {
  const double pause_s = backoff_s(config_.retry_s, live.failures++);
  live.retry_s = now_s_ + pause_s;
  live.next_s = unix_now_s() + pause_s;
}

// What kept it from its last step does not keep it from the next.
void JobManager::forget_trouble(std::int64_t id) {
  const auto found = live_.find(id);
  if (found == live_.end()) return;
  LiveJob& live = found->second;
  live.trouble.clear();
  live.told.clear();
  live.stage.clear();
  live.failures = 0;
  live.retry_s = 0;
}

// Its file cannot be taken or filed.
void JobManager::hold_up(const JobRecord& job, const std::string& trouble) {
  LiveJob& live = live_[job.id];
  if (live.trouble.empty()) live.trouble_since_s = unix_now_s();
  if (live.trouble != trouble) say(job, trouble);
  live.trouble = trouble;
  retry_later(live);
}

bool JobManager::is_tried_again(const JobRecord& job) {
  return job.state == JobState::kSending && job.tries > 0;
}

// As it stood before this try, which was cut short.
void JobManager::wait_on(JobRecord& job, const PrinterRecord* printer) {
  job.reason = job.trouble;
  store_.save_untold(job, printer);
}

// It is tried again, by the next daemon where this one ends. A reason that was told once since the
// first try is not told again, also where two take turns.
void JobManager::not_started(JobRecord job, const SendEnded& event) {
  LiveJob& live = live_[job.id];
  const PrinterRecord record = with_bed_as_before(job, event.failure.fault);
  steps_.apply(job, JobEventKind::kTrayNotBegun);
  if (live.ended_by_stop && job.tries > 0) return wait_on(job, &record);
  job.hint = event.failure.hint;
  if (live.ended_by_stop) {
    job.reason = "the daemon was stopped before the print began";
    return store_.save(job, job.reason, &record);
  }
  job.reason = printable(event.failure.what);
  const bool is_logged = live.told.contains(job.reason);  // by this daemon
  const bool is_told = is_logged || job.reason == job.trouble;
  if (job.tries++ == 0) job.trouble_since_s = unix_now_s();
  job.trouble = job.reason;
  is_told ? store_.save_untold(job, &record) : store_.save(job, job.reason, &record);
  live.told.insert(job.reason);
  retry_later(live);
  if (!is_logged) say(job, "not started: " + job.reason + ". It is tried again.");
}

void JobManager::started_after_all(std::int64_t id) {
  const auto found = store_.open_jobs().find(id);
  if (found == store_.open_jobs().end() || !is_tried_again(found->second)) return;
  JobRecord job = found->second;
  const std::string tries = job.tries == 1 ? "one try" : std::to_string(job.tries) + " tries";
  steps_.apply(job, JobEventKind::kTrayBegunAfterAll);
  live_[id].told.clear();
  store_.save(job, "started after " + tries + " in vain");
  say(job, "started after all");
}

std::optional<Trouble> JobManager::trouble_of(const JobRecord& job) const {
  const LiveJob* known = live(job.id);
  if (known != nullptr && !known->trouble.empty())
    return Trouble{known->trouble, known->trouble_since_s, known->failures,
                   known->with_folder_worker ? 0 : known->next_s};
  if (job.tries == 0) return std::nullopt;
  const bool waits_for_its_time = job.state == JobState::kApproved && known != nullptr &&
                                  waits_for(*this, job) == Waits::kNothing;
  return Trouble{job.trouble, job.trouble_since_s, job.tries,
                 waits_for_its_time ? known->next_s : 0};
}

}  // namespace packmerger
