// The jobs that the store has in memory, as the database has them: those that are not done with,
// and those that ended last. For job_store.cpp only.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "job/store/job_store.h"

namespace packmerger {

class JobsAtHand {
 public:
  // Which job had the same bytes before, for one of these.
  struct Same {
    std::string sha256;    // those bytes
    std::int64_t job = 0;  // 0: none
  };

  const std::map<std::int64_t, JobRecord>& open() const { return open_; }
  const EndedJobs& ended() const { return ended_; }
  bool has(const JobRecord& job) const;

  // A job was written, read, or is gone. sha256_before: of the bytes that it had until then.
  void written(JobRecord job, const std::string& sha256_before);
  void forgotten(const JobRecord& job);

  // What remember() was told of the job, while it is still true.
  std::optional<std::int64_t> same_before(const JobRecord& job) const;
  void remember(const JobRecord& job, std::int64_t same) { same_[job.id] = {job.sha256, same}; }

 private:
  void bytes_changed(std::int64_t id, const std::string& sha256);

  std::map<std::int64_t, JobRecord> open_;
  EndedJobs ended_;
  std::map<std::int64_t, Same> same_;
  std::uint64_t editions_ = 0;
};

}  // namespace packmerger
