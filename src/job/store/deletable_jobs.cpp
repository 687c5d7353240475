#include "job/store/deletable_jobs.h"

#include <map>
#include <string>
#include <string_view>

#include "job/store/job_rows.h"
#include "job/store/sqlite.h"

namespace packmerger {
namespace {

constexpr std::int64_t kFirstThatDeletes = 9;  // version of the tables

// Of two jobs in one folder neither is deleted before the other.
constexpr std::string_view kDeletable =
    "WHERE ended_s > 0 AND ended_s <= ? AND filing_done = 1 AND deleted_s = 0 AND NOT EXISTS "
    "(SELECT 1 FROM job AS other WHERE other.folder = job.folder AND other.folder <> '' AND "
    "(other.ended_s = 0 OR other.ended_s > ? OR other.filing_done = 0))";

}  // namespace

namespace sqlite {

std::vector<JobRecord> deletable(const Connection& connection, double until_s, int limit) {
  Statement rows(connection,
                 select_jobs(std::string(kDeletable) + " ORDER BY ended_s, id LIMIT ?"));
  rows.bind(until_s).bind(until_s).bind(std::int64_t{limit});
  return read_jobs(rows);
}

std::int64_t count_deletable(const Connection& connection, double until_s) {
  Statement row(connection, "SELECT COUNT(*) FROM job " + std::string(kDeletable));
  row.bind(until_s).bind(until_s);
  return row.step() ? row.integer() : 0;
}

double ended_beyond(const Connection& connection, int kept) {
  Statement row(connection,
                "SELECT ended_s FROM job WHERE ended_s > 0 AND deleted_s = 0 "
                "ORDER BY ended_s DESC LIMIT 1 OFFSET ?");
  row.bind(std::int64_t{kept});
  return row.step() ? row.real() : 0;
}

std::vector<JobRecord> sharing(const Connection& connection, const JobRecord& job) {
  Statement rows(connection,
                 select_jobs("WHERE id = ? OR (folder = ? AND folder <> '') ORDER BY id"));
  rows.bind(job.id).bind(job.folder);
  return read_jobs(rows);
}

std::vector<std::int64_t> to_delete(const Connection& connection) {
  Statement rows(connection, "SELECT id FROM job WHERE to_delete = 1 ORDER BY id");
  std::vector<std::int64_t> jobs;
  while (rows.step()) jobs.push_back(rows.integer());
  return jobs;
}

}  // namespace sqlite

std::vector<std::vector<std::int64_t>> read_deletable(const std::filesystem::path& file,
                                                      double until_s) {
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored)) return {};
  sqlite::Connection connection(file);
  // the index of its log is made in memory, not in a file beside it, and the log stays as it is
  connection.run("PRAGMA locking_mode = EXCLUSIVE");
  sqlite3_db_config(connection.get(), SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 1, nullptr);
  sqlite::Statement version(connection, "PRAGMA user_version");
  if (!version.step() || version.integer() < kFirstThatDeletes) return {};
  sqlite::Statement rows(connection, "SELECT id, folder FROM job " + std::string(kDeletable) +
                                         " ORDER BY ended_s, id");
  rows.bind(until_s).bind(until_s);
  std::vector<std::vector<std::int64_t>> groups;
  std::map<std::string, std::size_t> group_of;  // by folder
  while (rows.step()) {
    const std::int64_t id = rows.integer();
    const std::string folder = rows.text();
    const auto [found, is_new] = group_of.try_emplace(folder, groups.size());
    if (is_new || folder.empty()) {
      found->second = groups.size();
      groups.emplace_back();
    }
    groups[found->second].push_back(id);
  }
  return groups;
}

}  // namespace packmerger
