// What pages are shown of the jobs, the printers and the disk, kept from one look to the next, so
// that a look costs little where little changed and tells only that. On the loop's thread.
#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "daemon/jobs/job_manager.h"

namespace packmerger {

class StateBoard {
 public:
  // job manager must outlive it.
  explicit StateBoard(const JobManager& job_manager) : job_manager_(job_manager) {}

  // Looks at everything. Returns what changed since the look before, JSON text as docs/API.md has
  // it; empty: nothing. Where it throws (the database), the next look tells what this one found.
  std::string look();

  // All of it as the last look found it: the very text that the verb state is answered with.
  std::string state() const;

 private:
  struct Shown {
    std::uint64_t edition = 0;  // of the job's record
    nlohmann::json recorded;
    nlohmann::json passing;
    mutable std::string text;  // of both; empty: not made yet
  };
  // By id or by name. A change holds the keys that have another value than before.
  template <typename Key>
  struct Changes {
    std::map<Key, nlohmann::json> changed;
    std::set<Key> gone;

    void add(const Key& key, const nlohmann::json& change);
    void take_away(const Key& key);
  };

  void look_at(const JobRecord& job);
  void look_at_jobs();
  void look_at_printers();
  static const std::string& text_of(const Shown& job);

  const JobManager& job_manager_;
  std::map<std::int64_t, Shown> jobs_;
  std::vector<std::int64_t> listed_;  // the jobs in their order
  std::map<std::string, nlohmann::json> printers_;
  nlohmann::json storage_ = nlohmann::json::object();
  nlohmann::json troubles_ = nlohmann::json::array();
  Changes<std::int64_t> changed_jobs_;  // and not told yet
  Changes<std::string> changed_printers_;
  nlohmann::json changed_storage_ = nlohmann::json::object();
  bool changed_troubles_ = false;
};

}  // namespace packmerger
