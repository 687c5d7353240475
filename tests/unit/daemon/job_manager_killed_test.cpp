// What a daemon that was killed had under way.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "delivery/progress_file.h"
#include "unit/daemon/workshop.h"

namespace packmerger {
namespace {

constexpr int kMost = 5;  // times in a row

TEST(Killed, WhatWasBeingPreparedIsPreparedAgainButNotForEver) {
  Workshop shop;
  shop.drop("sim", "a.stl");
  for (int kills = 1; kills < kMost; ++kills) {
    ASSERT_TRUE(shop.prepare_order());
    shop.start();
    EXPECT_EQ(shop.job(1).cut_short, kills);
  }
  ASSERT_TRUE(shop.prepare_order());
  shop.start();
  EXPECT_EQ(shop.job(1).state, JobState::kFailed);
  EXPECT_EQ(shop.job(1).reason, "the daemon died 5 times in a row while it was being prepared");
  EXPECT_FALSE(shop.prepare_order());
}

TEST(Killed, OnePreparationThatEndsBeginsTheCountAnew) {
  Workshop shop;
  shop.drop("sim", "a.stl");
  ASSERT_TRUE(shop.prepare_order());
  shop.start();
  shop.prepare(*shop.prepare_order());
  EXPECT_EQ(shop.job(1).cut_short, 0);
}

TEST(Killed, ADaemonThatIsEndedIsNotCounted) {
  Workshop shop;
  shop.drop("sim", "a.stl");
  for (int ends = 0; ends < 2 * kMost; ++ends) {
    ASSERT_TRUE(shop.prepare_order());
    shop.job_manager_->stop();
    shop.tell(PrepareFailed{1, {Fault::kInterrupted, "Cancelled", ""}});
    EXPECT_EQ(shop.job(1).state, JobState::kReceived);
    shop.start();
  }
  EXPECT_EQ(shop.job(1).cut_short, 0);
  EXPECT_EQ(shop.job(1).state, JobState::kPreparing);
}

// Only one of them may be why, and it takes the others with it once.
TEST(Killed, ThoseThatMayBeWhyAreNotPreparedTogether) {
  Workshop shop;
  shop.config_.prepare.workers = 3;
  for (const char* name : {"a.stl", "b.stl", "c.stl"}) shop.drop("sim", name);
  shop.start();
  EXPECT_EQ(shop.prepare_order().value().job, 1);
  EXPECT_FALSE(shop.prepare_order());
  shop.drop("sim", "d.stl");
  EXPECT_EQ(shop.prepare_order().value().job, 4) << "what is new waits for nobody";
  shop.start();
  EXPECT_EQ(shop.job(1).cut_short, 2);
  EXPECT_EQ(shop.job(2).cut_short, 1);
  const PrepareOrder first = shop.prepare_order().value();
  shop.prepare(first);
  EXPECT_EQ(shop.prepare_order().value().job, 2);
}

// Its sender writes a record before the first byte.
TEST(Killed, APrintOfWhichNothingWasSentWaitsWithItsTries) {
  Workshop shop;
  shop.drop("real", "a.stl");
  shop.prepare(*shop.prepare_order());
  shop.job_manager_->clear("real");
  shop.turn();
  ASSERT_TRUE(shop.send_order("real"));
  SendEnded ended{1, SendOutcome::kNotStarted, {Fault::kUnavailable, "nobody answers", "x"}, ""};
  shop.tell(ended);
  shop.now_s_ += 1000;
  shop.turn();
  const SendOrder again = shop.send_order("real").value();
  EXPECT_FALSE(shop.store_->printer("real").bed_clear);
  std::ofstream(again.told_file) << "";  // its sender opened it
  shop.start();
  const SendOrder after = shop.send_order("real").value();
  EXPECT_EQ(shop.job(1).state, JobState::kSending) << "its bed is as clear as it was";
  EXPECT_EQ(shop.job(1).tries, 1);
  EXPECT_EQ(shop.job(1).cut_short, 1);
  ProgressFile(after.told_file).acknowledged(0, 10);
  shop.start();
  EXPECT_EQ(shop.job(1).state, JobState::kFailed) << "what was begun is not begun again";
  EXPECT_FALSE(shop.store_->printer("real").bed_clear);
}

TEST(Killed, APrintThatKillsTheDaemonEachTimeFails) {
  Workshop shop;
  shop.drop("sim", "a.stl");
  shop.prepare(*shop.prepare_order());
  for (int kills = 0; kills < kMost; ++kills) {
    ASSERT_TRUE(shop.send_order("sim"));
    shop.start();
  }
  EXPECT_EQ(shop.job(1).state, JobState::kFailed);
  EXPECT_EQ(shop.job(1).reason, "the daemon died 5 times in a row before its print began");
}

TEST(Killed, APrintThatWasBeingCancelledDoesNotBegin) {
  Workshop shop;
  shop.drop("sim", "a.stl");
  shop.prepare(*shop.prepare_order());
  ASSERT_TRUE(shop.send_order("sim"));
  shop.job_manager_->cancel(1);
  shop.start();
  EXPECT_EQ(shop.job(1).state, JobState::kCancelled);
  EXPECT_FALSE(shop.send_order("sim"));
}

TEST(Killed, AnOrderToPrintAtOnceIsNotKept) {
  Workshop shop;
  shop.drop("real", "a.stl");
  shop.prepare(*shop.prepare_order());
  JobRecord job = shop.job(1);
  job.at_once = true;
  shop.store_->save(job);
  shop.job_manager_->clear("real");
  shop.turn();
  ASSERT_TRUE(shop.send_order("real"));
  shop.start();
  EXPECT_FALSE(shop.send_order("real"));
  EXPECT_TRUE(shop.job(1).held);
  EXPECT_FALSE(shop.job(1).at_once);
}

}  // namespace
}  // namespace packmerger
