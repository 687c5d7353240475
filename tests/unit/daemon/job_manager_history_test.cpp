// What a job's history promises: its bytes, how it was prepared, what was sent, how it ended.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "delivery/progress_file.h"
#include "unit/daemon/workshop.h"

namespace packmerger {
namespace {

TEST(History, TheSameNameAgainIsASecondJobAndTheSameBytesAreTold) {
  Workshop shop;
  shop.drop("sim", "a.stl");
  shop.tell(Hashed{1, std::string(64, 'a')});
  shop.prepare(shop.prepare_order().value());
  shop.drop("sim", "a.stl");
  shop.tell(Hashed{2, std::string(64, 'b')});
  shop.prepare(shop.prepare_order().value());
  shop.drop("real", "b.stl");
  shop.tell(Hashed{3, std::string(64, 'a')});
  EXPECT_EQ(shop.view(2).at("name"), "a.stl");
  EXPECT_EQ(shop.view(2).at("same_as"), nullptr) << "other bytes";
  EXPECT_EQ(shop.view(3).at("same_as"), 1) << "another name, another printer, the same bytes";
  EXPECT_THAT(shop.log_, testing::HasSubstr("the same bytes as job 1"));
}

TEST(History, KeepsEverythingAboutAPrintAcrossARestart) {
  Workshop shop;
  shop.job_manager_->clear("real");
  shop.drop("real", "a.stl");
  shop.tell(Hashed{1, std::string(64, 'a')});
  shop.prepare(shop.prepare_order().value());
  const SendOrder send = shop.send_order("real").value();
  ProgressFile(send.told_file).acknowledged(300, 300);
  SendEnded end{1, SendOutcome::kDone, {}, ""};
  end.printed_s = 71;
  shop.tell(end);
  shop.run_the_folder_worker();
  shop.start();
  const json job = shop.view(1);
  EXPECT_EQ(job.at("state"), "done");
  EXPECT_EQ(job.at("sha256"), std::string(64, 'a'));
  EXPECT_EQ(job.at("profile"), "marlin");
  EXPECT_EQ(job.at("seed"), 1);
  EXPECT_EQ(job.at("predicted_s"), 60);
  EXPECT_EQ(job.at("printed_s"), 71);
  EXPECT_TRUE(job.at("estimates").contains("packed"));
  EXPECT_EQ(job.at("told").at("done"), 300);
  EXPECT_EQ(job.at("history").back().at("state"), "done");
  EXPECT_EQ(job.at("history").back().at("note"),
            "tray 1 is printed, told up to line 300 of 300 (100 %)");
  EXPECT_GE(job.at("ended_s"), job.at("sending_s"));
}

// More jobs than a page holds have ended since: what still waits is told all the same.
TEST(History, WhatHasNotEndedIsAlwaysToldAndTheRestPageByPage) {
  Workshop shop;
  shop.job_manager_->pause("real", true);
  shop.drop("real", "waits.stl");
  for (int i = 0; i < 7; ++i) {
    shop.drop("real", "ends.stl");
    if (i != 3) shop.job_manager_->cancel(i + 2);
  }
  const auto ids = [&](json request) {
    request["verb"] = "jobs.list";
    std::vector<std::int64_t> told;
    const json reply = shop.ask(request);
    for (const json& job : reply.at("result")) told.push_back(job.at("id"));
    return told;
  };
  using Ids = std::vector<std::int64_t>;
  EXPECT_EQ(ids({{"limit", 2}}), (Ids{5, 1, 8, 7}));
  EXPECT_EQ(ids({{"limit", 2}, {"before", 7}}), (Ids{6, 4}));
  EXPECT_EQ(ids({{"limit", 2}, {"before", 4}}), (Ids{3, 2}));
  EXPECT_EQ(ids({{"limit", 2}, {"before", 2}}), Ids{});
  shop.job_manager_->cancel(1);
  EXPECT_EQ(ids({{"limit", 2}}), (Ids{5, 1, 8})) << "it ended last";
  const json state = shop.ask({{"verb", "state"}, {"limit", 1}}).at("result").at("jobs");
  EXPECT_EQ(state.size(), 2U);
}

}  // namespace
}  // namespace packmerger
