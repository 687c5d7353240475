// How files come to the job manager, and where they go at the end. What lies in watched folders is
// touched by their folder workers alone (folder_worker.h).
#include "base/names.h"
#include "base/storage/move_file.h"
#include "base/time/wall_clock.h"
#include "daemon/intake/beside.h"
#include "daemon/jobs/job_manager.h"
#include "daemon/jobs/job_notes.h"
#include "model/files/job_folder_names.h"

namespace packmerger {
namespace {

bool is_there(const fs::path& path) {
  std::error_code ignored;
  return fs::exists(path, ignored);
}

std::string sentences(const Failure& failure) {
  return printable(failure.what + (failure.hint.empty() ? "" : ". " + failure.hint));
}

bool is_good(const JobRecord& job) {
  return job.state == JobState::kDone || job.state == JobState::kHandedOver;
}

}  // namespace

Queue<FolderOrder>& JobManager::folder_queue_of(const JobRecord& job) {
  return queues_.folders[fs::path(job.origin).parent_path()].orders;
}

JobRecord JobManager::begun(JobEventKind event, const PrinterConfig& printer,
                            const fs::path& origin, bool with_settings) {
  JobRecord job;
  steps_.apply(job, event);
  job.printer = printer.name;
  job.name = origin.filename().string();
  job.origin = origin.string();
  job.with_settings = with_settings;
  job.received_s = unix_now_s();
  job = store_.add(job);
  job.input = (job_path(job.id) / "input" / job.name).string();
  store_.save(job);
  return job;
}

// Recorded, and only then moved.
void JobManager::on(const Arrived& event) {
  const PrinterConfig* printer = config_.printer(event.printer);
  if (stopping_ || printer == nullptr) return;
  claim(begun(JobEventKind::kArrived, *printer, event.file, event.with_settings));
}

void JobManager::claim(const JobRecord& job) {
  const bool is_dropped = job.again_of == 0;
  live_[job.id].with_folder_worker = true;
  folder_queue_of(job).push(ClaimOrder{job.id, job.origin, job.input,
                                       job.with_settings && is_dropped, job.by_copy && is_dropped});
}

void JobManager::on(const Claimed& event) {
  std::optional<JobRecord> job = store_.find(event.job);
  if (job && job->state == JobState::kClaiming) {
    if (event.outcome == ClaimOutcome::kOtherFileSystem) {
      steps_.apply(*job, JobEventKind::kOnAnotherDisk);
      store_.save(*job);
      return folder_queue_of(*job).push(
          FetchOrder{job->id, job->origin, job->input, job->with_settings, false});
    }
    if (event.outcome == ClaimOutcome::kTaken)
      settle(*job);
    else if (!is_there(job->input))
      return forget(*job);  // it lies where it was
    else
      hold_up(*job, sentences(event.failure));
  }
  live_[event.job].with_folder_worker = false;
}

void JobManager::on(const Fetched& event) {
  std::optional<JobRecord> job = store_.find(event.job);
  if (job && job->state == JobState::kClaiming) {
    if (event.failure && job->again_of != 0) {
      job->input.clear();
      end(*job, JobEventKind::kFileGone, printable(event.failure->what), event.failure->hint);
    } else if (event.failure) {
      return forget(*job);
    } else {
      if (job->again_of != 0) job->with_settings = has_settings_beside(job->input);
      settle(*job);
    }
  }
  live_[event.job].with_folder_worker = false;
}

// The job's file is here, and so are its settings.
void JobManager::settle(JobRecord job) {
  steps_.apply(job, JobEventKind::kTaken);
  store_.save(job);
  forget_trouble(job.id);
  say(job, "received");
}

void JobManager::forget(JobRecord job) {
  steps_.apply(job, JobEventKind::kNotTaken);
  std::error_code ignored;
  fs::remove_all(job_path(job.id), ignored);
  store_.forget(job.id);
  live_.erase(job.id);
}

// What died while claiming: the file is here, whole, or it never left its place.
void JobManager::finish_claim(const JobRecord& job) {
  const LiveJob* known = live(job.id);
  if (known != nullptr && (known->with_folder_worker || now_s_ < known->retry_s)) return;
  if (job.input.empty() || !is_there(job.input)) return forget(job);
  claim(job);
}

// An upload lies in the state folder, as the job's own copy does.
bool JobManager::take_upload(const JobRecord& job, const fs::path& file) {
  try {
    if (rename_new(file, job.input) == Moved::kYes) {
      settle(job);
      return true;
    }
    live_[job.id].with_folder_worker = true;
    queues_.folders[file.parent_path()].orders.push(
        FetchOrder{job.id, file, job.input, false, false});
    return true;
  } catch (const Error& error) {
    // what the database could not be told, advance() sees on the disk
    say(job, error.what() + (" " + error.hint()));
    if (is_there(job.input)) return true;
    forget(job);
    return false;
  }
}

// The place is recorded before the file is moved there, so that an interrupted move is finished.
void JobManager::file_away(const JobRecord& ended) {
  LiveJob& live = live_[ended.id];
  if (live.with_folder_worker || preparing_.contains(ended.id) || now_s_ < live.retry_s) return;
  live.with_folder_worker = true;
  const fs::path folder =
      fs::path(ended.origin).parent_path() / (is_good(ended) ? "done" : "failed");
  if (ended.filed.empty())
    folder_queue_of(ended).push(PlaceOrder{ended.id, folder, ended.name});
  else
    folder_queue_of(ended).push(file_order(ended));
}

FileOrder JobManager::file_order(const JobRecord& job) const {
  return {job.id,
          job.input,
          job.filed,
          job.with_settings,
          job.folder.empty() ? fs::path() : job.folder / fs::path(kPictureFile),
          note_beside(job.filed, is_good(job) ? kResultNote : kReasonNote),
          is_good(job) ? result_note(job) : reason_note(job)};
}

void JobManager::on(const Placed& event) {
  std::optional<JobRecord> job = store_.find(event.job);
  if (job && !event.failure) {
    steps_.apply(*job, JobEventKind::kPlaced);
    job->filed = event.to.string();
    store_.save(*job);
    return folder_queue_of(*job).push(file_order(*job));
  }
  if (job) hold_up(*job, "not yet filed: " + sentences(*event.failure));
  live_[event.job].with_folder_worker = false;
}

void JobManager::on(const Filed& event) {
  std::optional<JobRecord> job = store_.find(event.job);
  if (event.failure && job) {
    if (event.failure->fault == Fault::kBusy) {  // the name was taken meanwhile
      steps_.apply(*job, JobEventKind::kNameTaken);
      job->filed.clear();
      store_.save(*job);
    } else {
      hold_up(*job, "not yet filed: " + sentences(*event.failure));
    }
    live_[event.job].with_folder_worker = false;
    return;
  }
  if (job) {
    steps_.apply(*job, JobEventKind::kFiled);
    store_.save(*job);
  }
  live_.erase(event.job);
}

void JobManager::on(const FileIgnored& event) {
  log_(printable(event.file.string()) + ": not taken, " + event.reason);
}

}  // namespace packmerger
