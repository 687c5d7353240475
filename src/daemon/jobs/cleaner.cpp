#include "daemon/jobs/cleaner.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <sys/statvfs.h>

#include <algorithm>

#include "base/names.h"
#include "base/time/backoff.h"
#include "base/time/wall_clock.h"
#include "daemon/jobs/job_refusals.h"
#include "job/store/deletable_jobs.h"

namespace packmerger {
namespace {

constexpr double kLookEvery_s = 30;
constexpr double kDay_s = 86400;
constexpr double kAnnounced_s = 7 * kDay_s;
constexpr double kLeap_s =
    30 * kDay_s;  // between two looks: the daemon was off, or the clock leapt
constexpr int kAtATime = 10;
constexpr int kDoublings = 7;  // of the pause before what was left is deleted after all
constexpr std::uint64_t kLeastWanted = std::uint64_t{512} << 20;
constexpr const char* kFrom = "cleaning_from_s";  // what is remembered
constexpr const char* kLooked = "cleaning_looked_s";

double gib(std::uint64_t bytes) { return static_cast<double>(bytes) / (1 << 30); }

std::string day(double unix_s) {
  return fmt::format("{:%Y-%m-%d}", fmt::localtime(static_cast<std::time_t>(unix_s)));
}

}  // namespace

std::optional<DiskSpace> disk_space(const fs::path& place) {
  struct statvfs disk {};
  if (::statvfs(place.c_str(), &disk) != 0) return std::nullopt;
  return DiskSpace{std::uint64_t{disk.f_blocks} * disk.f_frsize,
                   std::uint64_t{disk.f_bavail} * disk.f_frsize};
}

Cleaner::Cleaner(const DaemonConfig& config, JobStore& store, const JobSteps& steps,
                 Queue<FolderOrder>& folder_worker, Log log, Measure measure)
    : config_(config),
      store_(store),
      steps_(steps),
      folder_worker_(folder_worker),
      log_(std::move(log)),
      measure_(std::move(measure)) {
  for (const std::int64_t id : store.to_delete()) wanted_.insert(id);
}

void Cleaner::serve(double now_s) {
  now_s_ = now_s;
  if (!deleting_.empty() || now_s < next_s_) return;
  const double wall_s = unix_now_s();
  look_at_room();
  look_back(wall_s);
  double until_s = announced_ ? 0 : kept_since_s(wall_s);
  if (room_ && room_->is_short()) until_s = std::max(until_s, wall_s - kSparedAfterEnd_s);
  std::vector<JobRecord> jobs;
  if (until_s > 0)
    jobs = store_.deletable(until_s, kAtATime + static_cast<int>(left_.size() + gone_.size()));
  add_wanted(jobs);
  std::erase_if(left_, [&](const auto& left) {
    return std::none_of(jobs.begin(), jobs.end(),
                        [&](const JobRecord& job) { return job.id == left.first; });
  });
  if (left_.empty()) trouble_.reset();
  order(jobs);
  next_s_ = now_s + kLookEvery_s;
  record();
}

// Those that somebody deleted, as long as nobody needs their folders again.
void Cleaner::add_wanted(std::vector<JobRecord>& jobs) const {
  for (const std::int64_t id : wanted_) {
    const std::optional<JobRecord> job = store_.find(id);
    const std::vector<JobRecord> sharing = job ? store_.sharing(*job) : std::vector<JobRecord>();
    if (std::all_of(sharing.begin(), sharing.end(), [](const JobRecord& one) {
          return has_ended(one.state) && one.filing_done && one.deleted_s == 0;
        }))
      jobs.insert(jobs.end(), sharing.begin(), sharing.end());
  }
}

// An upload of the largest kind must find its place; half of a disk is enough for it.
void Cleaner::look_at_room() {
  room_.reset();
  const std::optional<DiskSpace> disk = measure_(config_.state);
  if (!disk) return;
  room_ = Room{disk->free_bytes,
               std::max(kLeastWanted,
                        std::min(kLeastWanted + config_.web.most_upload_bytes, disk->bytes / 2))};
  if (room_->is_low() && !told_low_)
    log_(fmt::format("the disk with {} has only {:.1f} GiB left{}", config_.state.string(),
                     gib(room_->free_bytes),
                     room_->is_short() ? ": the folders of the oldest jobs are deleted" : ""));
  told_low_ = room_->is_low();
}

Cleaner::Memory Cleaner::remembered() const {
  if (unwritten_) return *unwritten_;
  return {store_.remembered(kFrom).value_or(0), store_.remembered(kLooked).value_or(0)};
}

// Whoever comes from a version that kept everything, was away for a month, or whose clock leapt,
// has seven days to say otherwise.
void Cleaner::look_back(double wall_s) {
  Memory memory = remembered();
  const double since_s = wall_s - memory.looked_s;
  const bool is_new = memory.looked_s == 0 && store_.is_empty();
  const bool leapt = !is_new && since_s > kLeap_s;
  if (leapt || memory.from_s > wall_s + kAnnounced_s) {
    memory.from_s = wall_s + kAnnounced_s;
    told_announced_ = false;
    unwritten_ = memory;
  }
  if (since_s < 0 || since_s > kDay_s) {
    memory.looked_s = wall_s;
    unwritten_ = memory;
  }
  announce(memory.from_s, wall_s);
}

void Cleaner::announce(double from_s, double wall_s) {
  announced_.reset();
  if (wall_s >= from_s) return;
  const Announced announced{from_s, store_.count_deletable(kept_since_s(wall_s))};
  announced_ = announced;
  if (announced.jobs > 0 && !told_announced_)
    log_(fmt::format(
        "from {} on the folders of {} ended jobs are deleted (keep_days = {}, keep_jobs = {}); set "
        "these to 0 to keep them as long as there is room",
        day(from_s), announced.jobs, config_.keep_days, config_.keep_jobs));
  told_announced_ = told_announced_ || announced.jobs > 0;
}

// Jobs that ended then or before are not kept; 0: all are.
double Cleaner::kept_since_s(double wall_s) const {
  double until_s = 0;
  if (config_.keep_days > 0) until_s = wall_s - config_.keep_days * kDay_s;
  if (config_.keep_jobs > 0) until_s = std::max(until_s, store_.ended_beyond(config_.keep_jobs));
  return std::max(until_s, 0.0);
}

void Cleaner::remove(const JobRecord& job) {
  if (!is_possible(job, JobEventKind::kDelete)) refuse(job, JobEventKind::kDelete);
  if (is_gone(job))
    throw Error(Fault::kUsage,
                "The folder of job " + std::to_string(job.id) +
                    (job.deleted_s > 0 ? " is deleted" : " is being deleted"),
                "What is known of the job is kept.");
  const std::vector<JobRecord> sharing = store_.sharing(job);
  for (const JobRecord& other : sharing)
    if (!has_ended(other.state))
      throw Error(
          Fault::kBusy,
          "Job " + std::to_string(other.id) + " needs the folder of job " + std::to_string(job.id),
          "Wait for its end, or cancel it first.");
  for (const JobRecord& other : sharing)
    if (!other.filing_done)
      throw Error(Fault::kBusy, title_of(other) + " is just being filed", "Try again in a moment.");
  left_.erase(job.id);
  wanted_.insert(job.id);
  unrecorded_.insert(job.id);
  record();
  order({job});
}

void Cleaner::order(const std::vector<JobRecord>& jobs) {
  std::map<std::int64_t, std::string> wanted;
  for (const JobRecord& job : jobs) {
    if (const auto left = left_.find(job.id); left != left_.end() && now_s_ < left->second.retry_s)
      continue;
    for (const JobRecord& other : store_.sharing(job))
      if (!deleting_.contains(other.id) && !gone_.contains(other.id))
        wanted.try_emplace(other.id, other.folder);
  }
  if (wanted.empty()) return;
  DeleteOrder order;
  for (const auto& item : wanted) {
    order.jobs.push_back(item.first);
    order.folders.push_back(config_.state / "jobs" / std::to_string(item.first));
  }
  deleting_.merge(wanted);
  folder_worker_.push(std::move(order));
}

void Cleaner::on(const Deleted& event) {
  for (const std::int64_t id : event.jobs) {
    gone_[id] = deleting_[id];
    deleting_.erase(id);
    left_.erase(id);
    wanted_.erase(id);
    unrecorded_.erase(id);
  }
  if (!event.jobs.empty())
    log_(fmt::format("the folders of {} ended jobs were deleted, {} the first", event.jobs.size(),
                     event.jobs.front()));
  if (event.failure) put_off(event);
  if (left_.empty()) trouble_.reset();
  next_s_ = 0;
  record();
}

// What cannot be written now is tried again at the next look. It is told by those who cannot do
// without: the events of the jobs.
void Cleaner::record() {
  try {
    while (!gone_.empty()) {
      std::optional<JobRecord> job = store_.find(gone_.begin()->first);
      if (job && is_possible(*job, JobEventKind::kDeleted)) {
        steps_.apply(*job, JobEventKind::kDeleted);
        store_.save(*job, "its folder was deleted");
      }
      gone_.erase(gone_.begin());
    }
    while (!unrecorded_.empty()) {
      std::optional<JobRecord> job = store_.find(*unrecorded_.begin());
      if (job && is_possible(*job, JobEventKind::kDelete)) {
        steps_.apply(*job, JobEventKind::kDelete);
        store_.save(*job);
      }
      unrecorded_.erase(unrecorded_.begin());
    }
    if (!unwritten_) return;
    store_.remember(kFrom, unwritten_->from_s);
    store_.remember(kLooked, unwritten_->looked_s);
    unwritten_.reset();
  } catch (const Error&) {
  }
}

// Told in one line until all of them could be deleted.
void Cleaner::put_off(const Deleted& event) {
  const std::string why = printable(event.failure->what) + ". " + event.failure->hint;
  double pause_s = 0;
  for (const std::int64_t id : event.left) {
    deleting_.erase(id);
    Left& left = left_[id];
    pause_s = backoff_s(config_.retry_s, left.failures++, kDoublings);
    left.retry_s = now_s_ + pause_s;
  }
  if (!trouble_) {
    log_("not deleted: " + why);
    trouble_ = Trouble{{}, unix_now_s(), 0, 0};
  }
  trouble_->what = fmt::format("{} folders cannot be deleted: {}", left_.size(), why);
  ++trouble_->tries;
  trouble_->next_s = unix_now_s() + pause_s;
}

bool Cleaner::is_gone(const JobRecord& job) const {
  const auto holds_it = [&](const std::map<std::int64_t, std::string>& folders) {
    return folders.contains(job.id) ||
           (!job.folder.empty() &&
            std::any_of(folders.begin(), folders.end(),
                        [&](const auto& one) { return one.second == job.folder; }));
  };
  return job.deleted_s > 0 || holds_it(deleting_) || holds_it(gone_);
}

}  // namespace packmerger
