// Databases that earlier versions wrote.
#include <gtest/gtest.h>
#include <sqlite3.h>

#include "base/files.h"
#include "job/store/job_store.h"

namespace packmerger {
namespace {

constexpr const char* kDropSinceVersion12 =
    "DROP INDEX job_to_delete; ALTER TABLE job DROP COLUMN to_delete; ALTER TABLE job DROP COLUMN "
    "cut_short;";

constexpr const char* kDropSinceVersion7 =
    "ALTER TABLE job DROP COLUMN trouble; ALTER TABLE job DROP COLUMN trouble_since_s; "
    "ALTER TABLE job DROP COLUMN tries; ALTER TABLE job DROP COLUMN turn; ALTER TABLE job DROP "
    "COLUMN wanted; DROP INDEX job_folder; "
    "ALTER TABLE job DROP COLUMN "
    "deleted_s; DROP TABLE memory;"
    "DROP INDEX job_ended; ALTER TABLE job DROP COLUMN approved; ALTER TABLE job DROP COLUMN "
    "doubt;";

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
  const std::string sql =
      kDropSinceVersion12 + drop + "PRAGMA user_version = " + std::to_string(version);
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
  age(file, 1, std::string(kDropSinceVersion1) + kDropSinceVersion6 + kDropSinceVersion7);
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
  age(file, 6, std::string(kDropSinceVersion6) + kDropSinceVersion7);
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

TEST(JobSchema, AFileWithoutWishesIsTakenOver) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "jobs.sqlite";
  const std::int64_t id = JobStore(file).add(prepared_job()).id;
  age(file, 12, "");
  JobStore store(file);
  JobRecord back = store.find(id).value();
  EXPECT_FALSE(back.to_delete);
  EXPECT_EQ(back.cut_short, 0);
  EXPECT_TRUE(store.to_delete().empty());
  back.to_delete = true;
  back.cut_short = 2;
  store.save(back);
  EXPECT_EQ(store.find(id)->cut_short, 2);
  EXPECT_EQ(store.to_delete(), std::vector<std::int64_t>{id});
}

// Its history tells what was approved, and that of a job printed again was nobody's approval.
TEST(JobSchema, WhatWasApprovedBeforeIsKnown) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "jobs.sqlite";
  {
    JobStore store(file);
    JobRecord doubtful = prepared_job();
    doubtful.state = JobState::kReceived;
    doubtful = store.add(doubtful);
    doubtful.state = JobState::kPreparing;
    store.save(doubtful);
    doubtful.state = JobState::kReady;
    store.save(doubtful, "leaves the build volume");
    store.save(doubtful, "held");
    for (const char* note : {"approved", "the program of job 1 again"}) {
      JobRecord approved = store.add(prepared_job());
      approved.state = JobState::kApproved;
      store.save(approved, note);
    }
  }
  age(file, 7, kDropSinceVersion7);
  JobStore store(file);
  EXPECT_FALSE(store.find(1)->approved);
  EXPECT_EQ(store.find(1)->doubt, "leaves the build volume");
  EXPECT_TRUE(store.find(2)->approved);
  EXPECT_FALSE(store.find(3)->approved);
}

}  // namespace
}  // namespace packmerger
