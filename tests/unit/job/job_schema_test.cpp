// Databases that earlier versions wrote.
#include <gtest/gtest.h>
#include <sqlite3.h>

#include "base/files.h"
#include "job/job_store.h"

namespace packmerger {
namespace {

constexpr const char* kDropSinceVersion6 = "ALTER TABLE job DROP COLUMN tray_files;";

constexpr const char* kDropSinceVersion1 =
    "ALTER TABLE job DROP COLUMN told; ALTER TABLE job DROP COLUMN told_total;"
    "ALTER TABLE job DROP COLUMN variant; ALTER TABLE job DROP COLUMN at_once;"
    "ALTER TABLE job DROP COLUMN with_settings; DROP INDEX job_printed;"
    "ALTER TABLE job DROP COLUMN predicted_s; ALTER TABLE job DROP COLUMN predicted_by;"
    "ALTER TABLE job DROP COLUMN printed_s; ALTER TABLE job DROP COLUMN paused_s;"
    "ALTER TABLE job DROP COLUMN chosen_by; ALTER TABLE job DROP COLUMN choice;"
    "ALTER TABLE job DROP COLUMN profile; ALTER TABLE job DROP COLUMN seed;";

// Makes a database of today's version one of an earlier version.
void age(const fs::path& file, int version, const std::string& drop) {
  sqlite3* raw = nullptr;
  ASSERT_EQ(sqlite3_open(file.c_str(), &raw), SQLITE_OK);
  const std::string sql = drop + "PRAGMA user_version = " + std::to_string(version);
  ASSERT_EQ(sqlite3_exec(raw, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK);
  sqlite3_close(raw);
}

JobRecord prepared_job() {
  JobRecord job;
  job.printer = "replicator";
  job.name = "b\xC3\xBCnny.stl";
  job.state = JobState::kReady;
  job.folder = "/job";
  job.trays = 2;
  job.seed = 9;
  job.tray_files = "[2]";
  return job;
}

TEST(JobSchema, AFileOfTheFirstVersionIsTakenOver) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "jobs.sqlite";
  const std::int64_t id = JobStore(file).add(prepared_job()).id;
  age(file, 1, std::string(kDropSinceVersion1) + kDropSinceVersion6);
  JobStore store(file);
  const JobRecord back = store.find(id).value();
  EXPECT_EQ(back.name, prepared_job().name);
  EXPECT_EQ(back.told_total, 0);
  EXPECT_EQ(back.tray_files, "");
}

TEST(JobSchema, JobsPreparedBeforeTheirTraysWereHashedAreTakenOver) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "jobs.sqlite";
  const std::int64_t id = JobStore(file).add(prepared_job()).id;
  age(file, 6, kDropSinceVersion6);
  for (const char* expected : {"", "[1]"}) {  // the second time it is of today's version
    JobStore store(file);
    JobRecord back = store.find(id).value();
    EXPECT_EQ(back.seed, 9);
    EXPECT_EQ(back.trays, 2);
    EXPECT_EQ(back.tray_files, expected);
    EXPECT_EQ(store.open_jobs().at(id).tray_files, expected);
    back.tray_files = "[1]";
    store.save(back);
  }
}

}  // namespace
}  // namespace packmerger
