// Which jobs' folders are deleted, when, and what stays.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "http/server.h"
#include "unit/daemon/workshop.h"

namespace packmerger {
namespace {

constexpr double kDay_s = 86400;

class Cleaning : public testing::Test {
 protected:
  // A job that was printed so many days ago.
  std::int64_t printed(double days_ago) {
    shop_.drop("sim", "a.stl");
    const PrepareOrder order = shop_.prepare_order().value();
    shop_.prepare(order);
    shop_.send_order("sim");
    SendEnded end{order.job, SendOutcome::kDone, {}, ""};
    end.printed_s = 71;
    shop_.tell(end);
    shop_.run_the_folder_worker();
    JobRecord job = shop_.job(order.job);
    job.ended_s -= days_ago * kDay_s;
    shop_.store_->save(job);
    return job.id;
  }
  void wait() {
    shop_.now_s_ += 60;
    shop_.turn();
    shop_.run_the_folder_worker();
  }
  fs::path folder(std::int64_t id) { return shop_.config_.state / "jobs" / std::to_string(id); }
  bool is_there(std::int64_t id) { return fs::exists(folder(id)); }
  json storage() { return shop_.ask({{"verb", "storage"}}).at("result"); }
  json remove(std::int64_t id) { return shop_.ask({{"verb", "jobs.delete"}, {"id", id}}); }

  Workshop shop_;
};

TEST_F(Cleaning, TakesFoldersOfOldJobsAndNothingThatIsKnownOfThem) {
  const std::int64_t old = printed(100);
  const std::int64_t young = printed(80);
  wait();
  EXPECT_FALSE(is_there(old));
  EXPECT_TRUE(is_there(young));
  const json job = shop_.view(old);
  EXPECT_EQ(job.at("state"), "done");
  EXPECT_EQ(job.at("folder"), "");
  EXPECT_GT(job.at("deleted_s"), 0);
  EXPECT_EQ(job.at("printed_s"), 71);
  EXPECT_TRUE(job.at("estimates").is_object());
  EXPECT_EQ(job.at("history").back().at("note"), "its folder was deleted");
  EXPECT_TRUE(fs::exists(std::string(job.at("filed")))) << "the model stays";
  EXPECT_EQ(shop_.store_->finished_prints("sim", "slicer", 9).size(), 2U) << "what it taught";
  EXPECT_EQ(shop_.view(young).at("deleted_s"), nullptr);
}

TEST_F(Cleaning, KeepsSoManyAndAllWhereTheSettingsSaySo) {
  for (const double days : {4.0, 3.0, 2.0}) printed(days);
  shop_.config_.keep_jobs = 0;
  wait();
  EXPECT_TRUE(is_there(1));
  shop_.config_.keep_jobs = 2;
  wait();
  EXPECT_FALSE(is_there(1));
  EXPECT_TRUE(is_there(2));
  const std::int64_t old = printed(1000);
  shop_.config_.keep_jobs = shop_.config_.keep_days = 0;
  wait();
  EXPECT_TRUE(is_there(old));
}

TEST_F(Cleaning, IsAnnouncedForAWeekAfterAnUpgradeOrALeapOfTheClock) {
  const std::int64_t old = printed(100);
  for (const double looked_s : {0.0, unix_now_s() - 40 * kDay_s}) {
    shop_.store_->remember("cleaning_looked_s", looked_s);
    shop_.start();
    wait();
    EXPECT_TRUE(is_there(old));
    EXPECT_EQ(storage().at("announced").at("jobs"), 1);
    EXPECT_NEAR(storage().at("announced").at("from_s"), unix_now_s() + 7 * kDay_s, 600);
    EXPECT_THAT(shop_.log_,
                testing::HasSubstr("the folders of 1 ended jobs are deleted (keep_days"));
  }
  shop_.start();
  wait();
  EXPECT_TRUE(is_there(old)) << "the next start does not end the week";
  shop_.store_->remember("cleaning_from_s", unix_now_s() - 1);
  wait();
  EXPECT_FALSE(is_there(old));
  EXPECT_EQ(storage().at("announced"), nullptr);
}

// Whatever the settings keep, and before an announced week is over: a disk that is full of old jobs
// refuses no new one.
TEST_F(Cleaning, TheOldestGoWhereTheDiskGetsFullButNoneOfTheLastDay) {
  const std::int64_t old = printed(3), new_one = printed(0.5);
  shop_.config_.keep_jobs = shop_.config_.keep_days = 0;
  shop_.config_.web.most_upload_bytes = std::uint64_t{1} << 30;
  Queue<FolderOrder> folder_worker;
  DiskSpace disk{std::uint64_t{100} << 30, std::uint64_t{4} << 30};
  std::string log;
  Cleaner cleaner(
      shop_.config_, *shop_.store_, shop_.job_manager_->steps(), folder_worker,
      [&](const std::string& line) { log += line + "\n"; }, [&](const fs::path&) { return disk; });
  double now_s = 0;
  const auto look = [&](double free_gib) {
    disk.free_bytes = static_cast<std::uint64_t>(free_gib * (1 << 30));
    cleaner.serve(now_s += 60);
    return folder_worker.try_pop();
  };
  EXPECT_FALSE(look(3.5));
  EXPECT_FALSE(cleaner.room()->is_low());
  EXPECT_FALSE(look(2));
  EXPECT_THAT(log, testing::HasSubstr("has only 2.0 GiB left\n")) << "people are warned early";
  const auto order = look(1.4);
  ASSERT_TRUE(order);
  EXPECT_THAT(std::get<DeleteOrder>(*order).jobs, testing::ElementsAre(old));
  cleaner.on(Deleted{{old}, {}, {}});
  EXPECT_FALSE(look(1.4)) << "job " << new_one << " ended today";
}

// Old jobs are never why an upload that the settings allow finds no room, on a small disk either.
TEST_F(Cleaning, TheLargestUploadFindsRoomOnASmallDisk) {
  printed(3);
  shop_.config_.keep_jobs = shop_.config_.keep_days = 0;
  shop_.config_.web.most_upload_bytes = std::uint64_t{1} << 30;
  Queue<FolderOrder> folder_worker;
  const DiskSpace disk{std::uint64_t{8} << 30, std::uint64_t{5} << 28};
  Cleaner cleaner(
      shop_.config_, *shop_.store_, shop_.job_manager_->steps(), folder_worker,
      [](const std::string&) {}, [&](const fs::path&) { return disk; });
  cleaner.serve(60);
  EXPECT_TRUE(folder_worker.try_pop());
  EXPECT_GE(cleaner.room()->wanted_bytes,
            HttpLimits{}.spare_bytes + shop_.config_.web.most_upload_bytes);
}

TEST_F(Cleaning, AJobPrintedAgainNeedsTheFolder) {
  const std::int64_t old = printed(100);
  shop_.job_manager_->hold(shop_.job_manager_->again(old).id);
  wait();
  EXPECT_TRUE(is_there(old));
  EXPECT_EQ(remove(old).at("error").at("fault"), 75) << "job 2 needs it";
  shop_.job_manager_->cancel(2);
  EXPECT_TRUE(remove(2).at("ok"));
  EXPECT_FALSE(shop_.ask({{"verb", "jobs.again"}, {"id", 2}}).at("ok") &&
               shop_.job(3).state == JobState::kApproved)
      << "it is being deleted";
  shop_.run_the_folder_worker();
  EXPECT_FALSE(is_there(old));
  EXPECT_GT(shop_.job(old).deleted_s, 0) << "with the job that shares it";
}

TEST_F(Cleaning, ByHandAndThenPreparedAnew) {
  const std::int64_t job = printed(0);
  shop_.drop("sim", "b.stl");
  EXPECT_EQ(remove(2).at("error").at("fault"), 2) << "it has not ended";
  EXPECT_EQ(remove(9).at("error").at("fault"), 66);
  EXPECT_TRUE(remove(job).at("ok"));
  EXPECT_TRUE(is_there(job)) << "the folder_worker has not come to it";
  EXPECT_THAT(shop_.log_, testing::HasSubstr("its folder is being deleted"));
  EXPECT_THAT(std::string(remove(job).at("error").at("what")),
              testing::EndsWith("is being deleted"));
  shop_.run_the_folder_worker();
  EXPECT_FALSE(is_there(job));
  EXPECT_EQ(remove(job).at("error").at("fault"), 2) << "it is deleted";
  EXPECT_THAT(std::string(remove(job).at("error").at("what")), testing::EndsWith(" is deleted"));
  EXPECT_TRUE(shop_.ask({{"verb", "jobs.again"}, {"id", job}}).at("ok"));
  shop_.run_the_folder_worker();
  EXPECT_EQ(shop_.job(3).state, JobState::kReceived) << "from the model below done/";
  fs::remove(shop_.job(job).filed);
  const json gone = shop_.ask({{"verb", "jobs.again"}, {"id", job}}).at("result");
  shop_.run_the_folder_worker();
  EXPECT_EQ(shop_.view(gone.at("id")).at("state"), "failed");
  EXPECT_NE(shop_.view(gone.at("id")).at("hint"), "");
}

TEST_F(Cleaning, GoesOnWhereADaemonDied) {
  const std::int64_t old = printed(100);
  fs::path half = folder(old);
  half += ".deleted";
  fs::rename(folder(old), half);
  shop_.start();
  wait();
  EXPECT_FALSE(fs::exists(half));
  EXPECT_GT(shop_.job(old).deleted_s, 0);
}

TEST_F(Cleaning, AWishOutlivesTheDaemon) {
  const std::int64_t job = printed(0);
  EXPECT_TRUE(remove(job).at("ok"));
  shop_.start();  // before the folder worker came to it
  EXPECT_TRUE(is_there(job));
  wait();
  EXPECT_FALSE(is_there(job));
  EXPECT_GT(shop_.job(job).deleted_s, 0);
  EXPECT_FALSE(shop_.job(job).to_delete) << "it is done";
}

TEST_F(Cleaning, AFolderThatStaysKeepsNoOther) {
  const fs::path folder = shop_.folder_.path() / "old";
  fs::create_directories(folder);
  const Deleted deleted = clear_away(DeleteOrder{{1, 2}, {"/proc/self/task", folder}});
  EXPECT_THAT(deleted.left, testing::ElementsAre(1));
  EXPECT_THAT(deleted.jobs, testing::ElementsAre(2));
  EXPECT_FALSE(fs::exists(folder));
}

TEST_F(Cleaning, WhatCannotBeDeletedIsTriedEverLessOftenToldOnceAndSeen) {
  const std::int64_t stays = printed(100);
  const std::int64_t goes = printed(100);
  int tries = 0;
  const auto pass = [&](double hours) {
    for (const double end_s = shop_.now_s_ + 3600 * hours; shop_.now_s_ < end_s;) {
      shop_.now_s_ += 30;
      shop_.turn();
      while (const std::optional<FolderOrder> order = shop_.folder_order()) {
        Deleted deleted;
        for (const std::int64_t job : std::get<DeleteOrder>(*order).jobs)
          (job == stays ? deleted.left : deleted.jobs).push_back(job);
        if (!deleted.left.empty()) {
          ++tries;
          deleted.failure = {Fault::kCannotWrite, "it is busy", "Wait."};
        }
        shop_.tell(deleted);
      }
    }
  };
  const auto troubles = [&] { return shop_.ask({{"verb", "troubles"}}).at("result"); };
  EXPECT_EQ(troubles(), json::array());
  pass(2);
  EXPECT_GE(tries, 5);
  EXPECT_LE(tries, 15) << "of 240 looks";
  EXPECT_GT(shop_.job(goes).deleted_s, 0);
  EXPECT_EQ(shop_.job(stays).deleted_s, 0);
  ASSERT_EQ(troubles().size(), 1U);
  EXPECT_EQ(troubles().at(0).at("about"), "deleting old jobs");
  EXPECT_EQ(troubles().at(0).at("tries"), tries);
  const std::size_t first = shop_.log_.find("it is busy");
  ASSERT_NE(first, std::string::npos);
  EXPECT_EQ(shop_.log_.find("it is busy", first + 1), std::string::npos) << shop_.log_;
  shop_.config_.keep_days = 0;
  pass(1);
  EXPECT_EQ(troubles(), json::array()) << "nobody wants it deleted";
  EXPECT_TRUE(remove(stays).at("ok"));
  const int before = tries;
  pass(1);
  EXPECT_GE(tries, before + 2) << "what somebody deleted is tried again, whatever is kept";
  shop_.config_.keep_days = 90;
  shop_.now_s_ += 7200;
  shop_.turn();
  shop_.run_the_folder_worker();
  EXPECT_FALSE(is_there(stays));
  EXPECT_EQ(troubles(), json::array());
}

}  // namespace
}  // namespace packmerger
