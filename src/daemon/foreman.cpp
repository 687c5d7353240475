#include "daemon/foreman.h"

#include <algorithm>
#include <chrono>

#include "daemon/job_view.h"
#include "daemon/model_options.h"
#include "daemon/move_file.h"
#include "daemon/waits.h"

namespace packmerger {
namespace {

constexpr int kMostDoublings = 4;  // of retry_s
constexpr int kMostPrints = 100;   // that a correction is learned from, the newest

bool is_there(const fs::path& path) {
  std::error_code ignored;
  return fs::exists(path, ignored);
}

void remove_if_same(const fs::path& original, const fs::path& copy) {
  std::error_code failed;
  if (!is_there(original)) return;
  const bool same = fs::file_size(original, failed) == fs::file_size(copy, failed) && !failed &&
                    sha256_hex_of_file(original) == sha256_hex_of_file(copy);
  if (same) fs::remove(original, failed);
}

// A folder's name for people: the model's name and the job's number.
std::string handoff_name(const JobRecord& job) {
  std::string stem = fs::path(printable(job.name)).stem().string();
  stem.resize(std::min<std::size_t>(stem.size(), 200));
  return stem + "-" + std::to_string(job.id);
}

}  // namespace

double wall_clock_s() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

Foreman::Foreman(const DaemonConfig& config, JobStore& store, Crew& crew, Log log)
    : config_(config), store_(store), crew_(crew), log_(std::move(log)) {}

fs::path Foreman::job_path(std::int64_t id) const {
  return config_.state / "jobs" / std::to_string(id);
}

fs::path Foreman::told_file(const JobRecord& job) const {
  return job_path(job.id) / ("sent-" + std::to_string(job.next_tray) + ".progress");
}

void Foreman::say(const JobRecord& job, const std::string& text) const {
  log_("job " + std::to_string(job.id) + " (" + printable(job.name) + ", " + job.printer +
       "): " + printable(text));
}

const LiveJob* Foreman::live(std::int64_t id) const {
  const auto found = live_.find(id);
  return found == live_.end() ? nullptr : &found->second;
}

std::int64_t Foreman::sending_at(const std::string& printer) const {
  const auto found = sending_.find(printer);
  return found == sending_.end() ? 0 : found->second;
}

const std::optional<Correction>& Foreman::correction(const std::string& printer,
                                                     const std::string& source) const {
  const auto [found, is_new] = corrections_.try_emplace({printer, source});
  if (is_new)
    found->second = learn_correction(store_.finished_prints(printer, source, kMostPrints));
  return found->second;
}

void Foreman::end(JobRecord& job, JobState state, const std::string& reason,
                  const std::string& hint, const std::string& note, const PrinterRecord* printer) {
  job.state = state;
  job.reason = reason;
  job.hint = hint;
  job.ended_s = wall_clock_s();
  job.filing_done = job.input.empty();
  store_.save(job, note.empty() ? reason : note, printer);
  say(job, std::string(state_name(state)) + (reason.empty() ? "" : ": " + reason));
}

void Foreman::recover() {
  std::map<std::int64_t, JobRecord> open = store_.open_jobs();  // which the store then changes
  for (auto& [id, job] : open) {
    if (job.at_once) drop_order(job);
    if (job.state == JobState::kClaiming) finish_claim(job);
    if (job.state != JobState::kSending) continue;
    const PrinterConfig* printer = config_.printer(job.printer);
    if (printer != nullptr && printer->hands_over()) {
      job.state = JobState::kApproved;  // handing over twice gives the same folder
      store_.save(job, "the daemon was interrupted; handing over again");
    } else {
      note_told(job);
      end(job, JobState::kFailed, with_told(job, "interrupted while printing"),
          "See what the printer did, clear its bed, and print again with packmerger jobs again " +
              std::to_string(job.id) + ".");
    }
  }
}

// Who wanted a print at once meant the printer as it stood then. What lies on it when a daemon
// starts again, after a power cut or a week, nobody has looked at.
void Foreman::drop_order(JobRecord& job) {
  const PrinterConfig* printer = config_.printer(job.printer);
  if (has_ended(job.state) || job.state == JobState::kSending) return;
  if (job.next_tray > 1) return;  // somebody has to clear the bed for the rest
  if (printer != nullptr && !printer->has_bed()) return;
  job.at_once = false;
  job.held = job.held || job.state == JobState::kApproved;
  if (job.state == JobState::kApproved) job.reason = "the order to print it at once is an old one";
  store_.save(job, "the daemon was started again: not printed by an order of before");
}

bool Foreman::is_refused(const fs::path& file) {
  std::erase_if(refused_, [&](const auto& item) { return item.second <= now_s_; });
  return refused_.contains(file);
}

bool Foreman::arrived(const PrinterConfig& printer, const fs::path& file) {
  if (stopping_ || is_refused(file)) return false;
  if (std::any_of(live_.begin(), live_.end(),
                  [&](const auto& item) { return item.second.fetching_from == file; }))
    return true;
  return claim(begun(printer, file, has_settings_beside(file)), file);
}

JobRecord Foreman::begun(const PrinterConfig& printer, const fs::path& origin, bool with_settings) {
  JobRecord job;
  job.printer = printer.name;
  job.name = origin.filename().string();
  job.origin = origin.string();
  job.with_settings = with_settings;
  job.received_s = wall_clock_s();
  job = store_.add(job);
  job.input = (job_path(job.id) / "input" / job.name).string();
  store_.save(job);
  return job;
}

bool Foreman::claim(JobRecord job, const fs::path& file) {
  try {
    if (rename_new(file, job.input) == Moved::kOtherFileSystem) {
      job.by_copy = true;
      store_.save(job);
      live_[job.id].fetching_from = file;
      crew_.clerk.push(FetchOrder{job.id, file, job.input, job.with_settings});
    } else {
      finish_claim(job);
    }
    return true;
  } catch (const Error& error) {
    // what the database could not be told, advance() sees on the disk
    if (error.fault() != Fault::kNoInput) say(job, error.what() + (" " + error.hint()));
    if (!is_there(job.input)) forget(job);
    return error.fault() == Fault::kNoInput;
  }
}

void Foreman::forget(const JobRecord& job) {
  std::error_code ignored;
  fs::remove_all(job_path(job.id), ignored);
  store_.forget(job.id);
  live_.erase(job.id);
}

// What died while claiming: the file is here, whole, or it never left its place.
void Foreman::finish_claim(JobRecord job) {
  if (job.input.empty() || !is_there(job.input)) return forget(job);
  if (!take_settings(job)) return;
  remove_copied_original(job);
  job.state = JobState::kReceived;
  store_.save(job);
  say(job, "received");
}

// The settings file follows its model; one that a copied model came with was copied before it.
// False where that cannot be done now.
bool Foreman::take_settings(const JobRecord& job) {
  if (!job.with_settings || has_settings_beside(job.input) || !has_settings_beside(job.origin))
    return true;
  LiveJob& live = live_[job.id];
  if (now_s_ < live.retry_s) return false;
  try {
    rename_new(settings_beside(job.origin), settings_beside(job.input));
    return true;
  } catch (const Error& error) {
    say(job, error.what() + (" " + error.hint()));
    live.retry_s = retry_at(live.failures++);
    return false;
  }
}

void Foreman::remove_copied_original(const JobRecord& job) const {
  if (!job.by_copy || job.again_of != 0) return;
  remove_if_same(job.origin, job.input);
  if (job.with_settings) remove_if_same(settings_beside(job.origin), settings_beside(job.input));
}

void Foreman::advance(double now_s) {
  now_s_ = now_s;
  notice_printers();
  const std::map<std::int64_t, JobRecord>& open = store_.open_jobs();  // a step changes it
  std::vector<std::int64_t> jobs;
  for (const auto& [id, job] : open)
    if (may_step(job)) jobs.push_back(id);
  // a job whose first trays are printed goes before the others
  std::stable_partition(jobs.begin(), jobs.end(),
                        [&](std::int64_t id) { return open.at(id).next_tray > 1; });
  for (const std::int64_t id : jobs)
    if (const auto job = open.find(id); job != open.end()) step(job->second);
  drop_idle_live_jobs();
}

// Thousands may wait to be prepared, and this is asked of each at every turn of the loop.
bool Foreman::may_step(const JobRecord& job) const {
  if (job.state == JobState::kReceived || job.state == JobState::kPreparing)
    return is_free(preparer_of(job));
  return job.state != JobState::kSending;
}

void Foreman::drop_idle_live_jobs() {
  std::erase_if(live_, [&](const auto& item) {
    const LiveJob& live = item.second;
    const bool idle =
        !live.cancel_prepare && !live.control && !live.with_clerk && live.fetching_from.empty();
    return idle && !store_.open_jobs().contains(item.first);
  });
}

double Foreman::retry_at(int failures) const {
  return now_s_ + config_.retry_s * (1 << std::min(failures, kMostDoublings));
}

void Foreman::step(const JobRecord& job) {
  if (has_ended(job.state)) return file_away(job);
  if (stopping_) return;
  switch (job.state) {
    case JobState::kClaiming:
      if (live(job.id) == nullptr || live(job.id)->fetching_from.empty()) finish_claim(job);
      return;
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

void Foreman::start_sending(const JobRecord& approved) {
  const PrinterConfig* printer = config_.printer(approved.printer);
  if (printer == nullptr || waits_for(*this, approved) != Waits::kNothing) return;
  LiveJob& live = live_[approved.id];
  if (now_s_ < live.retry_s) return;
  JobRecord job = approved;
  PrinterRecord record = store_.printer(job.printer);
  if (printer->has_bed()) record.bed_clear = false;
  job.state = JobState::kSending;
  job.reason.clear();
  job.hint.clear();
  job.told = job.told_total = 0;
  if (job.sending_s == 0) job.sending_s = wall_clock_s();
  store_.save(job, "tray " + std::to_string(job.next_tray) + " of " + std::to_string(job.trays),
              &record);
  std::error_code untold;  // the sender tells where its file cannot be made
  fs::create_directories(job_path(job.id), untold);
  sending_[job.printer] = job.id;
  live.control = std::make_shared<PrintControl>();
  live.print = {};
  crew_.senders.at(job.printer)
      .push({job.id, job.folder, job.next_tray, handoff_name(job), told_file(job), live.control,
             job.tray_files});
  say(job, "sending tray " + std::to_string(job.next_tray) + " of " + std::to_string(job.trays));
}

// The place is recorded before the file is moved there, so that an interrupted move is finished.
void Foreman::file_away(const JobRecord& ended) {
  LiveJob& live = live_[ended.id];
  if (live.with_clerk || preparing_.contains(ended.id) || now_s_ < live.retry_s) return;
  JobRecord job = ended;
  const bool good = job.state == JobState::kDone || job.state == JobState::kHandedOver;
  if (job.filed.empty() || (is_there(job.input) && is_there(job.filed))) {
    const fs::path base = fs::path(job.origin).parent_path();
    job.filed = free_path(base / (good ? "done" : "failed"), job.name).string();
    store_.save(job);
  }
  live.with_clerk = true;
  crew_.clerk.push(FileOrder{job.id, job.input, job.filed, job.with_settings,
                             job.folder.empty() ? fs::path() : job.folder / fs::path("preview.png"),
                             note_beside(job.filed, good ? ".result.json" : ".reason.txt"),
                             good ? result_note(job) : reason_note(job)});
}

void Foreman::stop() {
  stopping_ = true;
  for (auto& [id, live] : live_) {
    if (live.cancel_prepare) *live.cancel_prepare = true;
    if (!live.control) continue;
    live.ended_by_stop = !live.control->cancelled();
    live.control->cancel();
  }
}

}  // namespace packmerger
