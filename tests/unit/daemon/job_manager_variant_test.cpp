// Another way of printing than the one that was prepared.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "unit/daemon/workshop.h"

namespace packmerger {
namespace {

using testing::Contains;
using testing::IsSupersetOf;
using testing::Not;

json wanted(std::int64_t id, const char* variant) {
  return {{"verb", "jobs.prepare"}, {"id", id}, {"variant", variant}};
}

TEST(Variant, AJobThatIsReadyIsPreparedAnew) {
  Workshop shop;
  shop.config_.printers[2].options.variant = "packed";
  const fs::path file = shop.drop("sim", "a.stl");
  const PrepareOrder first = shop.prepare_order().value();
  shop.prepare(first, 2, false);
  EXPECT_TRUE(shop.ask(wanted(1, "hollow")).at("ok"));
  shop.start();
  const PrepareOrder second = shop.prepare_order().value();
  EXPECT_THAT(second.argv, Contains("hollow"));
  EXPECT_NE(second.out, first.out);
  EXPECT_THAT(first.argv, Not(Contains("--compared")));
  EXPECT_THAT(second.argv, IsSupersetOf({std::string("--compared"), first.out.string()}));
  EXPECT_EQ(shop.view(1).at("doubt"), nullptr);
  shop.prepare(second);
  EXPECT_EQ(shop.job(1).trays, 1);
  EXPECT_TRUE(shop.send_order("sim")) << "the settings approve what has no doubt";
}

TEST(Variant, AnApprovedJobLosesItsApproval) {
  Workshop shop;
  shop.drop("real", "a.stl");
  shop.prepare(*shop.prepare_order(), 2, false);
  EXPECT_TRUE(shop.ask({{"verb", "jobs.approve"}, {"id", 1}}).at("ok"));
  EXPECT_EQ(shop.job(1).state, JobState::kApproved) << "the bed has to be cleared";
  EXPECT_TRUE(shop.ask(wanted(1, "solid")).at("ok"));
  EXPECT_FALSE(shop.job(1).approved);
  EXPECT_FALSE(shop.job(1).at_once);
  shop.job_manager_->clear("real");
  shop.job_manager_->advance(shop.now_s_);
  shop.prepare(*shop.prepare_order(), 1, false);
  EXPECT_EQ(shop.view(1).at("waits_for"), "approval");
  EXPECT_FALSE(shop.send_order("real"));
}

TEST(Variant, WhatIsToStartAtOnceDoesNotInAnotherWay) {
  Workshop shop;
  shop.config_.printers[2].approve = Approve::kAsk;
  shop.drop("sim", "a.stl");
  JobRecord job = shop.job(1);
  shop.prepare(*shop.prepare_order(), 1, false);
  job = shop.job(1);
  job.at_once = true;
  shop.store_->save(job, "");
  EXPECT_TRUE(shop.ask(wanted(1, "solid")).at("ok"));
  shop.job_manager_->advance(shop.now_s_);
  shop.prepare(*shop.prepare_order());
  EXPECT_EQ(shop.job(1).state, JobState::kReady);
}

TEST(Variant, TheAdviceIsToldWithOneJob) {
  Workshop shop;
  shop.drop("sim", "a.stl");
  EXPECT_EQ(shop.view(1).at("advice"), nullptr) << "nothing is compared yet";
  const PrepareOrder order = shop.prepare_order().value();
  shop.prepare(order, 1, false);
  JobRecord job = shop.job(1);
  job.estimates = R"({"packed":{"fits":true,"time_s":5,"cost":3},
                      "hollow":{"fits":true,"time_s":5,"cost":2},"solid":{"fits":false,
                       "reason":"It stands on a point"}})";
  shop.store_->save(job, "");
  EXPECT_EQ(shop.view(1).at("advice").at("variant"), "hollow");
  EXPECT_FALSE(shop.view(1).at("advice").at("text").get<std::string>().empty());
  const json refused = shop.ask(wanted(1, "solid")).at("error");
  EXPECT_EQ(refused.at("fault"), 2) << "it cannot be made so";
  EXPECT_NE(refused.at("what").get<std::string>().find("It stands on a point"), std::string::npos);
}

TEST(Variant, AnEndedJobBecomesANewOne) {
  Workshop shop;
  shop.drop("sim", "a.stl");
  shop.prepare(*shop.prepare_order(), 1, false);
  shop.job_manager_->cancel(1);
  EXPECT_EQ(shop.ask(wanted(1, "solid")).at("error").at("fault"), 75) << "it is being filed";
  shop.job_manager_->advance(shop.now_s_);
  shop.run_the_folder_worker();
  shop.job_manager_->again(1);
  const json anew = shop.ask(wanted(2, "solid"));
  ASSERT_TRUE(anew.at("ok")) << anew;
  EXPECT_EQ(anew.at("result").at("id"), 3) << "job 2 has no model itself";
  EXPECT_EQ(shop.job(2).state, JobState::kCancelled);
  shop.run_the_folder_worker();
  EXPECT_THAT(shop.prepare_order()->argv,
              IsSupersetOf({std::string("solid"), std::string("--compared"), shop.job(1).folder}));
}

TEST(Variant, WhatIsHeldStaysHeldInTheNewJob) {
  Workshop shop;
  shop.config_.printers[2].approve = Approve::kAsk;
  shop.drop("sim", "a.stl");
  shop.prepare(*shop.prepare_order(), 1, false);
  shop.job_manager_->cancel(1);
  shop.job_manager_->advance(shop.now_s_);
  shop.run_the_folder_worker();
  shop.job_manager_->again(1);
  shop.job_manager_->hold(2);
  EXPECT_TRUE(shop.ask(wanted(2, "solid")).at("ok"));
  EXPECT_TRUE(shop.job(3).held);
}

TEST(Variant, WhatKeptTheOldWayFromPrintingIsForgotten) {
  Workshop shop;
  shop.drop("sim", "a.stl");
  shop.prepare(*shop.prepare_order());
  ASSERT_TRUE(shop.send_order("sim"));
  SendEnded ended;
  ended.job = 1;
  ended.outcome = SendOutcome::kNotStarted;
  ended.failure = {Fault::kUnavailable, "nobody answers", "switch it on"};
  shop.tell(ended);
  EXPECT_TRUE(shop.ask(wanted(1, "solid")).at("ok"));
  EXPECT_EQ(shop.view(1).at("hint"), "");
  shop.job_manager_->advance(shop.now_s_);
  shop.prepare(*shop.prepare_order());
  EXPECT_TRUE(shop.send_order("sim")) << "at once";
}

TEST(Variant, IsRefusedWhereItMakesNoSense) {
  Workshop shop;
  shop.drop("sim", "a.stl");
  EXPECT_EQ(shop.ask(wanted(1, "hollow")).at("error").at("fault"), 2) << "it is being prepared";
  shop.prepare(*shop.prepare_order(), 1, false);
  EXPECT_EQ(shop.ask(wanted(1, "holow")).at("error").at("fault"), 2);
  EXPECT_EQ(shop.ask({{"verb", "jobs.prepare"}, {"id", 1}}).at("error").at("fault"), 2);
  shop.job_manager_->approve(1);
  shop.job_manager_->advance(shop.now_s_);
  EXPECT_EQ(shop.ask(wanted(1, "hollow")).at("error").at("fault"), 2) << "it is printed";
  shop.drop("sim", "b.gcode");
  EXPECT_EQ(shop.ask(wanted(2, "hollow")).at("error").at("fault"), 2) << "a program";
  shop.drop("real", "c.stl");
  shop.config_.printers.erase(shop.config_.printers.begin() + 1);
  EXPECT_EQ(shop.ask(wanted(3, "hollow")).at("error").at("fault"), 66) << "its printer is gone";
}

}  // namespace
}  // namespace packmerger
