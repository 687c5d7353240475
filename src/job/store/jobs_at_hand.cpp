#include "job/store/jobs_at_hand.h"

#include <iterator>
#include <utility>

namespace packmerger {

bool JobsAtHand::has(const JobRecord& job) const {
  return open_.contains(job.id) || ended_.contains({job.ended_s, job.id});
}

void JobsAtHand::written(JobRecord job, const std::string& sha256_before) {
  if (sha256_before != job.sha256) {
    bytes_changed(job.id, sha256_before);
    bytes_changed(job.id, job.sha256);
  }
  job.edition = ++editions_;
  std::erase_if(ended_, [&](const auto& item) { return item.second.id == job.id; });
  if (job.ended_s > 0) ended_.insert_or_assign({job.ended_s, job.id}, job);
  if (job.ended_s == 0 || !job.filing_done)
    open_.insert_or_assign(job.id, job);
  else
    open_.erase(job.id);
  if (ended_.size() > kLastEnded) {
    const JobRecord oldest = std::prev(ended_.end())->second;
    ended_.erase(std::prev(ended_.end()));
    if (!has(oldest)) same_.erase(oldest.id);
  }
  if (!has(job)) same_.erase(job.id);
}

void JobsAtHand::forgotten(const JobRecord& job) {
  bytes_changed(job.id, job.sha256);
  open_.erase(job.id);
  same_.erase(job.id);
}

std::optional<std::int64_t> JobsAtHand::same_before(const JobRecord& job) const {
  const auto found = same_.find(job.id);
  if (found == same_.end() || found->second.sha256 != job.sha256) return std::nullopt;
  return found->second.job;
}

// Those after the job may have another one before them.
void JobsAtHand::bytes_changed(std::int64_t id, const std::string& sha256) {
  std::erase_if(same_,
                [&](const auto& item) { return item.first > id && item.second.sha256 == sha256; });
}

}  // namespace packmerger
