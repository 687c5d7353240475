// What may be deleted is known on a disk that takes not a single byte.
#include "job/store/deletable_jobs.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>

#include "base/files.h"
#include "fixtures/fault_of.h"

namespace packmerger {
namespace {

using testing::ElementsAre;

void add_ended(JobStore& store, const std::string& folder, double ended_s) {
  JobRecord job;
  job.printer = "sim";
  job.state = JobState::kReady;
  job.folder = folder;
  job = store.add(job);
  job.state = JobState::kFailed;
  job.ended_s = ended_s;
  job.filing_done = true;
  store.save(job);
}

// As a daemon leaves it that was killed: all of it is in the log beside the file.
fs::path copied(const fs::path& file, const fs::path& to) {
  fs::create_directory(to);
  for (const char* tail : {"", "-wal"})
    fs::copy_file(file.string() + tail, to / (file.filename().string() + tail));
  return to / file.filename();
}

TEST(ReadDeletable, NeedsNoRoom) {
  const TemporaryFolder folder;
  JobStore store(folder.path() / "jobs.sqlite");
  add_ended(store, "/jobs/1/job", 200);
  add_ended(store, "/jobs/2/job", 100);
  add_ended(store, "/jobs/1/job", 300);
  add_ended(store, "/jobs/4/job", 5000);
  const fs::path file = copied(folder.path() / "jobs.sqlite", folder.path() / "killed");
  const auto handler = ::signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  ::getrlimit(RLIMIT_FSIZE, &before);
  const rlimit none{0, before.rlim_max};
  ::setrlimit(RLIMIT_FSIZE, &none);
  const auto fault = fixtures::fault_of([&] { JobStore cannot_be_opened(file); });
  std::vector<std::vector<std::int64_t>> jobs;
  EXPECT_NO_THROW(jobs = read_deletable(file, 1000));
  ::setrlimit(RLIMIT_FSIZE, &before);
  ::signal(SIGXFSZ, handler);
  EXPECT_EQ(fault, Fault::kCannotWrite);
  EXPECT_THAT(jobs, ElementsAre(ElementsAre(2), ElementsAre(1, 3)));
  EXPECT_EQ(JobStore(file).newest_ended(9).size(), 4U) << "nothing was changed";
}

TEST(ReadDeletable, OfNoFileIsNothing) {
  const TemporaryFolder folder;
  EXPECT_TRUE(read_deletable(folder.path() / "jobs.sqlite", 1000).empty());
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

}  // namespace
}  // namespace packmerger
