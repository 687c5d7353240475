#include "job/store/job_store.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <signal.h>
#include <sqlite3.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <map>

#include "base/error.h"
#include "base/files.h"
#include "fixtures/fault_of.h"

namespace packmerger {
namespace {

using fixtures::fault_of;

const std::vector<JobState> kStates = {
    JobState::kClaiming, JobState::kReceived, JobState::kPreparing, JobState::kReady,
    JobState::kApproved, JobState::kSending,  JobState::kDone,      JobState::kHandedOver,
    JobState::kFailed,   JobState::kCancelled};

JobRecord sample(JobState state = JobState::kClaiming) {
  JobRecord job;
  job.printer = "replicator";
  job.name = "b\xC3\xBCnny'; DROP TABLE job; --.stl";
  job.origin = "/folders/x.stl";
  job.state = state;
  job.received_s = 1e9;
  return job;
}

TEST(JobState, NamesAreUniqueAndReadBack) {
  for (const JobState state : kStates) EXPECT_EQ(state_named(state_name(state)), state);
  EXPECT_FALSE(state_named("printing"));
}

TEST(JobState, EveryJobCanEndAndNoneComesBack) {
  for (const JobState from : kStates) {
    EXPECT_EQ(may_follow(from, JobState::kFailed), !has_ended(from));
    EXPECT_EQ(may_follow(from, JobState::kCancelled), !has_ended(from));
    if (!has_ended(from)) continue;
    for (const JobState to : kStates) EXPECT_FALSE(may_follow(from, to));
  }
  EXPECT_FALSE(may_follow(JobState::kReady, JobState::kSending)) << "never without approval";
  EXPECT_FALSE(may_follow(JobState::kReceived, JobState::kApproved));
}

TEST(JobStore, KeepsEveryFieldAcrossReopening) {
  const TemporaryFolder folder;
  JobRecord job = sample();
  {
    JobStore store(folder.path() / "jobs.sqlite");
    job = store.add(job);
    job.input = "/in";
    job.by_copy = true;
    job.sha256 = std::string(64, 'a');
    job.state = JobState::kReceived;
    job.held = true;
    job.attempt = 3;
    job.folder = "/job";
    job.trays = 4;
    job.next_tray = 2;
    job.pays = true;
    job.estimates = R"({"packed":null})";
    job.reason = std::string("a\0b", 3);
    job.hint = "hint";
    job.filed = "/done/x";
    job.again_of = 7;
    job.sending_s = 2.5;
    job.told = 120;
    job.told_total = 300;
    job.variant = "program";
    job.at_once = true;
    job.with_settings = true;
    job.predicted_s = 12.5;
    job.predicted_by = "slicer";
    job.printed_s = 13.5;
    job.paused_s = 1.5;
    job.chosen_by = "any";
    job.choice = "{}";
    job.profile = "marlin";
    job.seed = 7;
    job.tray_files = "[]";
    job.approved = true;
    job.doubt = "doubt";
    job.deleted_s = 4.5;
    job.wanted = "hollow";
    job.turn = 7;
    store.save(job, "note");
  }
  JobStore store(folder.path() / "jobs.sqlite");
  const JobRecord back = store.find(job.id).value();
  EXPECT_EQ(back.name, job.name);
  EXPECT_EQ(back.state, JobState::kReceived);
  EXPECT_EQ(back.reason, job.reason);
  EXPECT_TRUE(back.held && back.by_copy && back.pays && !back.filing_done);
  EXPECT_EQ(back.attempt, 3);
  EXPECT_EQ(back.trays, 4);
  EXPECT_EQ(back.next_tray, 2);
  EXPECT_EQ(back.again_of, 7);
  EXPECT_EQ(back.estimates, job.estimates);
  EXPECT_EQ(back.sending_s, 2.5);
  EXPECT_EQ(back.told, 120);
  EXPECT_EQ(back.told_total, 300);
  EXPECT_EQ(back.variant, "program");
  EXPECT_TRUE(back.at_once && back.with_settings);
  EXPECT_EQ(back.predicted_s, 12.5);
  EXPECT_EQ(back.predicted_by, "slicer");
  EXPECT_EQ(back.printed_s, 13.5);
  EXPECT_EQ(back.paused_s, 1.5);
  EXPECT_EQ(back.chosen_by, "any");
  EXPECT_EQ(back.choice, "{}");
  EXPECT_EQ(back.profile, "marlin");
  EXPECT_EQ(back.seed, 7);
  EXPECT_EQ(back.tray_files, "[]");
  EXPECT_TRUE(back.approved);
  EXPECT_EQ(back.doubt, "doubt");
  EXPECT_EQ(back.deleted_s, 4.5);
  EXPECT_EQ(back.wanted, "hollow");
  EXPECT_EQ(back.turn, 7);
  const std::vector<JobEvent> history = store.history(job.id);
  ASSERT_EQ(history.size(), 2U);
  EXPECT_EQ(history.back().note, "note");
}

TEST(JobStore, OnlyPrintsThatEndedWellTeach) {
  const TemporaryFolder folder;
  JobStore store(folder.path() / "jobs.sqlite");
  const auto print = [&](const std::string& printer, JobState end, double printed_s,
                         double paused_s = 0, const std::string& source = "slicer") {
    JobRecord job = sample();
    job.printer = printer;
    job = store.add(job);
    for (const JobState state : {JobState::kReceived, JobState::kPreparing, JobState::kReady,
                                 JobState::kApproved, JobState::kSending}) {
      job.state = state;
      store.save(job);
    }
    job.state = end;
    job.predicted_s = 100;
    job.predicted_by = source;
    job.printed_s = printed_s;
    job.paused_s = paused_s;
    store.save(job);
  };
  print("a", JobState::kDone, 110);
  print("a", JobState::kDone, 120, 600);
  print("a", JobState::kDone, 130, 4000);
  print("a", JobState::kDone, 0);
  print("a", JobState::kFailed, 50);
  print("a", JobState::kCancelled, 60);
  print("a", JobState::kDone, 140, 0, "moves");
  print("b", JobState::kDone, 150);
  const std::vector<FinishedPrint> prints = store.finished_prints("a", "slicer", 10);
  ASSERT_EQ(prints.size(), 2U);
  EXPECT_EQ(prints[0].printed_s, 120);
  EXPECT_EQ(prints[1].printed_s, 110);
  EXPECT_EQ(store.finished_prints("a", "slicer", 1).size(), 1U);
  EXPECT_EQ(store.finished_prints("b", "slicer", 10).size(), 1U);
  EXPECT_TRUE(store.finished_prints("c", "slicer", 10).empty());
}

TEST(JobStore, AcceptsExactlyTheAllowedSteps) {
  EXPECT_TRUE(rc::check("random walks over the states", [] {
    const TemporaryFolder folder;
    JobStore store(folder.path() / "jobs.sqlite");
    JobRecord job = store.add(sample());
    const auto steps = *rc::gen::container<std::vector<std::size_t>>(
        12, rc::gen::inRange<std::size_t>(0, kStates.size()));
    for (const std::size_t step : steps) {
      JobRecord next = job;
      next.state = kStates[step];
      const bool stays = has_ended(job.state) && job.state == next.state;
      const bool allowed = stays || may_follow(job.state, next.state);
      try {
        store.save(next);
        RC_ASSERT(allowed);
        job = next;
      } catch (const Error&) {
        RC_ASSERT(!allowed);
      }
      RC_ASSERT(store.find(job.id)->state == job.state);
    }
  }));
}

TEST(JobStore, IdsAreNeverUsedAgain) {
  const TemporaryFolder folder;
  JobStore store(folder.path() / "jobs.sqlite");
  const std::int64_t first = store.add(sample()).id;
  store.forget(first);
  EXPECT_FALSE(store.find(first));
  EXPECT_TRUE(store.history(first).empty());
  EXPECT_GT(store.add(sample()).id, first);
}

TEST(JobStore, ForgetsOnlyWhatIsStillBeingClaimed) {
  const TemporaryFolder folder;
  JobStore store(folder.path() / "jobs.sqlite");
  const JobRecord job = store.add(sample(JobState::kReceived));
  store.forget(job.id);
  EXPECT_TRUE(store.find(job.id));
}

TEST(JobStore, OpenJobsAreThoseWithSomethingLeftToDo) {
  const TemporaryFolder folder;
  JobStore store(folder.path() / "jobs.sqlite");
  JobRecord job = store.add(sample(JobState::kReceived));
  EXPECT_EQ(store.open_jobs().size(), 1U);
  job.state = JobState::kFailed;
  job.ended_s = 5;
  store.save(job);
  EXPECT_EQ(store.open_jobs().size(), 1U) << "its file is not filed yet";
  job.filing_done = true;
  store.save(job);
  EXPECT_TRUE(store.open_jobs().empty());
  EXPECT_EQ(store.newest_ended(10).size(), 1U);
}

TEST(JobStore, OlderJobsAreReachedPageByPage) {
  const TemporaryFolder folder;
  JobStore store(folder.path() / "jobs.sqlite");
  const std::vector<std::int64_t> order = {2, 7, 1, 3, 6, 4};  // job 5 has not ended
  for (int i = 0; i < 7; ++i) store.add(sample());
  for (std::size_t i = 0; i < order.size(); ++i) {
    JobRecord job = store.find(order[i]).value();
    job.state = JobState::kFailed;
    job.ended_s = 1000 - static_cast<double>(i / 2);  // two at a time
    store.save(job);
  }
  std::vector<std::int64_t> told;
  for (std::vector<JobRecord> page = store.newest_ended(3); !page.empty();
       page = store.newest_ended(3, page.back().id))
    for (const JobRecord& job : page) told.push_back(job.id);
  EXPECT_EQ(told, (std::vector<std::int64_t>{7, 2, 3, 1, 6, 4}));
  EXPECT_EQ(store.newest_ended(9, 5).size(), 4U) << "older than one that has not ended";
}

TEST(JobStore, KnowsWhichFoldersAreNeededNoMore) {
  const TemporaryFolder folder;
  JobStore store(folder.path() / "jobs.sqlite");
  EXPECT_TRUE(store.is_empty());
  const auto ended = [&](double ended_s, const char* prepared, bool filed = true) {
    JobRecord job = sample();
    job.folder = prepared;
    job = store.add(job);
    job.state = JobState::kFailed;
    job.ended_s = ended_s;
    job.filing_done = filed;
    store.save(job);
    return job;
  };
  ended(30, "/a");
  const JobRecord first = ended(20, "/b");
  ended(25, "");
  ended(10, "/c");
  ended(99, "/c");         // again, and later
  ended(15, "/d", false);  // not yet filed
  JobRecord again = first;
  again.state = JobState::kReady;
  again.ended_s = 0;
  again.filing_done = false;
  const JobRecord open = store.add(again);
  using Ids = std::vector<std::int64_t>;
  const auto ids = [](const std::vector<JobRecord>& jobs) {
    Ids all;
    for (const JobRecord& job : jobs) all.push_back(job.id);
    return all;
  };
  EXPECT_EQ(ids(store.deletable(50, 9)), (Ids{3, 1}));
  EXPECT_EQ(store.count_deletable(50), 2);
  EXPECT_EQ(ids(store.deletable(99, 9)), (Ids{4, 3, 1, 5}));
  EXPECT_EQ(ids(store.deletable(99, 1)), (Ids{4}));
  EXPECT_EQ(ids(store.sharing(first)), (Ids{first.id, open.id}));
  EXPECT_EQ(store.ended_beyond(2), 25);
  EXPECT_EQ(store.ended_beyond(6), 0);
  JobRecord deleted = store.find(5).value();
  deleted.deleted_s = 100;
  store.save(deleted, "its folder was deleted");
  EXPECT_EQ(store.ended_beyond(2), 20);
  EXPECT_FALSE(store.is_empty());
}

TEST(JobStore, RemembersFigures) {
  const TemporaryFolder folder;
  JobStore(folder.path() / "jobs.sqlite").remember("a", 1);
  JobStore store(folder.path() / "jobs.sqlite");
  EXPECT_EQ(store.remembered("a"), 1);
  store.remember("a", 2);
  EXPECT_EQ(store.remembered("a"), 2);
  EXPECT_EQ(store.remembered("b"), std::nullopt);
}

TEST(JobStore, RecognisesTheSameBytes) {
  const TemporaryFolder folder;
  JobStore store(folder.path() / "jobs.sqlite");
  JobRecord first = sample();
  first.sha256 = "abc";
  first = store.add(first);
  JobRecord second = store.add(first);
  EXPECT_EQ(store.same_bytes(second), first.id);
  JobRecord third = store.add(sample());
  EXPECT_EQ(store.same_bytes(third), 0) << "an unknown hash equals nothing";
}

TEST(JobStore, TheSameBytesAreFoundWheneverTheyBecomeKnown) {
  const TemporaryFolder folder;
  JobStore store(folder.path() / "jobs.sqlite");
  std::vector<JobRecord> jobs;
  for (int i = 0; i < 3; ++i) jobs.push_back(store.add(sample()));
  const auto hash = [&](std::size_t i, char letter) {
    jobs[i].sha256 = std::string(64, letter);
    store.save(jobs[i]);
  };
  const auto before_last = [&] { return store.same_bytes_before(jobs[2]); };
  hash(2, 'a');
  EXPECT_EQ(before_last(), 0);
  hash(0, 'a');
  EXPECT_EQ(before_last(), 1);
  hash(1, 'a');
  EXPECT_EQ(before_last(), 2);
  store.forget(jobs[1].id);
  EXPECT_EQ(before_last(), 1);
  hash(0, 'b');
  EXPECT_EQ(before_last(), 0);
  hash(2, 'b');
  EXPECT_EQ(before_last(), 1);
}

TEST(JobStore, TheLastEndedAreAtHandAsTheDatabaseHasThem) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "jobs.sqlite";
  const auto ids = [](const JobStore& store) {
    std::vector<std::int64_t> found;
    for (const auto& [key, job] : store.ended_jobs()) found.push_back(job.id);
    return found;
  };
  JobStore store(file);
  for (int i = 0; i < static_cast<int>(kLastEnded) + 5; ++i) {
    JobRecord job = store.add(sample());
    job.state = JobState::kFailed;
    job.ended_s = 1000 + i % 7;
    store.save(job);
    const std::uint64_t edition = store.open_jobs().at(job.id).edition;
    job.filing_done = i % 2 == 0;
    store.save(job);
    EXPECT_NE(edition, 0U);
    if (!job.filing_done) {
      EXPECT_GT(store.open_jobs().at(job.id).edition, edition);
    }
  }
  EXPECT_EQ(ids(store).size(), kLastEnded);
  std::vector<std::int64_t> asked;
  for (const JobRecord& job : store.newest_ended(static_cast<int>(kLastEnded) + 1))
    asked.push_back(job.id);
  asked.pop_back();
  EXPECT_EQ(ids(store), asked);
  EXPECT_EQ(ids(JobStore(file)), asked);
}

TEST(JobStore, JobAndBedAreWrittenInOneStep) {
  const TemporaryFolder folder;
  JobStore store(folder.path() / "jobs.sqlite");
  EXPECT_FALSE(store.printer("replicator").bed_clear) << "an unknown bed is not clear";
  store.save(PrinterRecord{"replicator", true, false});
  JobRecord job = store.add(sample());
  const PrinterRecord used{"replicator", false, false};
  job.state = JobState::kSending;
  EXPECT_EQ(fault_of([&] { store.save(job, "", &used); }), Fault::kInternal);
  EXPECT_TRUE(store.printer("replicator").bed_clear) << "rolled back with the forbidden step";
}

TEST(JobStore, RefusesWhatIsNoDatabaseOrOneFromTheFuture) {
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "text") << std::string(5000, 'x');
  EXPECT_EQ(fault_of([&] { JobStore(folder.path() / "text"); }), Fault::kIo);
  EXPECT_EQ(fault_of([&] { JobStore(folder.path()); }), Fault::kCannotWrite);
  { JobStore store(folder.path() / "new"); }
  sqlite3* raw = nullptr;
  ASSERT_EQ(sqlite3_open((folder.path() / "new").c_str(), &raw), SQLITE_OK);
  sqlite3_exec(raw, "PRAGMA user_version = 99", nullptr, nullptr, nullptr);
  sqlite3_close(raw);
  EXPECT_EQ(fault_of([&] { JobStore(folder.path() / "new"); }), Fault::kIo);
}

// Walks jobs through their life and tells each step on the pipe once it is committed.
[[noreturn]] void walk_jobs(const fs::path& file, int pipe) {
  JobStore store(file);
  for (;;) {
    JobRecord job = store.add(sample());
    for (const JobState state : {JobState::kClaiming, JobState::kReceived, JobState::kPreparing,
                                 JobState::kReady, JobState::kApproved, JobState::kSending}) {
      job.state = state;
      const PrinterRecord bed{"replicator", state != JobState::kSending, false};
      store.save(job, "step", &bed);
      const std::int64_t told[2] = {job.id, static_cast<std::int64_t>(state)};
      if (::write(pipe, told, sizeof told) != sizeof told) ::_exit(1);
    }
  }
}

TEST(JobStore, NothingThatWasToldIsLostWhenTheProcessIsKilled) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "jobs.sqlite";
  for (int round = 0; round < 25; ++round) {
    int ends[2];
    ASSERT_EQ(::pipe(ends), 0);
    const pid_t child = ::fork();
    if (child == 0) walk_jobs(file, ends[1]);
    ::close(ends[1]);
    ::usleep(static_cast<useconds_t>(5000 + 7000 * (round % 6)));
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
    std::map<std::int64_t, std::int64_t> told;
    std::int64_t step[2];
    while (::read(ends[0], step, sizeof step) == sizeof step) told[step[0]] = step[1];
    ::close(ends[0]);
    JobStore store(file);
    for (const auto& [id, state] : told) {
      const JobRecord job = store.find(id).value();
      const auto found = static_cast<std::int64_t>(job.state);
      EXPECT_TRUE(found == state || found == state + 1) << id << ": " << state << " " << found;
    }
  }
}

}  // namespace
}  // namespace packmerger
