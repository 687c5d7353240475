// Deletes the folders of jobs that ended: those that keep_days and keep_jobs no longer cover, and
// the oldest ones where the disk gets full. What is known of a job stays, and so does its model
// below done/ or failed/. On the loop's thread; the folder worker does what takes time.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "daemon/jobs/job_steps.h"
#include "daemon/orders/messages.h"
#include "daemon/settings/config.h"
#include "job/store/job_store.h"

namespace packmerger {

struct DiskSpace {
  std::uint64_t bytes = 0;
  std::uint64_t free_bytes = 0;  // for whoever asks
};
// Of the disk that holds this place; nothing where the system does not tell.
std::optional<DiskSpace> disk_space(const std::filesystem::path& place);

// Of the disk with the state folder.
struct Room {
  std::uint64_t free_bytes = 0;
  std::uint64_t wanted_bytes = 0;  // with less, old jobs are deleted

  bool is_short() const { return free_bytes < wanted_bytes; }
  bool is_low() const { return free_bytes < 2 * wanted_bytes; }  // people are warned
};

// What is deleted once people had time to object.
struct Announced {
  double from_s = 0;  // Unix time
  std::int64_t jobs = 0;
};

class Cleaner {
 public:
  using Log = std::function<void(const std::string&)>;
  using Measure = std::function<std::optional<DiskSpace>(const std::filesystem::path&)>;

  // Everything must outlive it.
  Cleaner(const DaemonConfig& config, JobStore& store, const JobSteps& steps,
          Queue<FolderOrder>& folder_worker, Log log, Measure measure = disk_space);

  // Looks from time to time. now_s: a clock that never goes back. What cannot be recorded now is
  // recorded later: folders are deleted where the disk has no room for a record.
  void serve(double now_s);

  // Deletes the folder of a job that has ended, whatever the settings keep. Where that cannot be
  // done now, it is tried again, by the next daemon too. Throws Error{kUsage}
  // where it has not ended or was deleted, Error{kBusy} where its folder is still needed.
  void remove(const JobRecord& job);

  // Throws nothing either where it cannot be recorded now.
  void on(const Deleted& event);

  // Whether the job's folder is there no more, or not for long.
  bool is_gone(const JobRecord& job) const;

  const std::optional<Room>& room() const { return room_; }  // nothing: the system does not tell
  const std::optional<Announced>& announced() const { return announced_; }
  // Folders that cannot be deleted, and are tried again ever less often.
  const std::optional<Trouble>& trouble() const { return trouble_; }

 private:
  // Unix times that the store keeps.
  struct Memory {
    double from_s = 0;    // nothing is deleted before
    double looked_s = 0;  // about when that was decided last
  };

  void look_at_room();
  Memory remembered() const;
  void look_back(double wall_s);
  void announce(double from_s, double wall_s);
  void record();
  double kept_since_s(double wall_s) const;
  void order(const std::vector<JobRecord>& jobs);
  void add_wanted(std::vector<JobRecord>& jobs) const;
  void put_off(const Deleted& event);

  const DaemonConfig& config_;
  JobStore& store_;
  const JobSteps& steps_;
  Queue<FolderOrder>& folder_worker_;
  Log log_;
  Measure measure_;
  std::optional<Room> room_;
  std::optional<Announced> announced_;
  std::map<std::int64_t, std::string> deleting_;  // with the folder worker; the folder of each
  std::map<std::int64_t, std::string> gone_;      // deleted, and not recorded yet
  std::optional<Memory> unwritten_;
  struct Left {
    int failures = 0;
    double retry_s = 0;  // not before, on the clock of serve()
  };
  std::map<std::int64_t, Left> left_;  // jobs whose folders could not be deleted
  std::set<std::int64_t> wanted_;      // deleted by somebody, and still there
  std::set<std::int64_t> unrecorded_;  // among those
  std::optional<Trouble> trouble_;
  double now_s_ = 0;
  double next_s_ = 0;
  bool told_low_ = false;
  bool told_announced_ = false;
};

}  // namespace packmerger
