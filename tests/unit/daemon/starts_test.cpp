// What a person's action would start at once is told before, and never happens unasked.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "unit/daemon/workshop.h"

namespace packmerger {
namespace {

json of_job(const char* verb, std::int64_t id) {
  return {{"verb", std::string("jobs.") + verb}, {"id", id}};
}

json at(const char* verb, const char* printer) {
  return {{"verb", std::string("printers.") + verb}, {"name", printer}};
}

class Starts : public testing::Test {
 protected:
  // Job 1: prepared, and its printer approves by itself, but nobody has cleared its bed.
  Starts() { ready("real"); }

  void ready(const char* printer, int trays = 1, bool pays = true) {
    shop_.drop(printer, "a.stl");
    shop_.prepare(*shop_.prepare_order(), trays, pays);
  }
  void end(std::int64_t id) { shop_.tell(SendEnded{id, SendOutcome::kDone, {}, ""}); }

  // The job that the action starts, as it is told where none is expected; 0: none is started, and
  // the action is done.
  std::int64_t starts(json request) {
    request["starts"] = 0;
    const json reply = shop_.ask(request);
    if (!reply.at("ok")) {
      told_ = reply.at("error").at("starts");
      EXPECT_EQ(reply.at("error").at("fault"), 2);
      return told_.at("job");
    }
    EXPECT_EQ(reply.at("result").value("starts", json()), nullptr);
    shop_.job_manager_->advance(shop_.now_s_);
    return 0;
  }
  // Whether it really does.
  std::int64_t does_start(json request, const char* printer, std::int64_t expected) {
    request["starts"] = expected;
    const json reply = shop_.ask(request);
    EXPECT_TRUE(reply.at("ok")) << reply;
    shop_.job_manager_->advance(shop_.now_s_);
    const auto order = shop_.send_order(printer);
    const std::int64_t started = order ? order->job : 0;
    EXPECT_EQ(reply.at("result").at("starts").value("job", std::int64_t{0}), started);
    return started;
  }

  Workshop shop_;
  json told_;
};

TEST_F(Starts, AClearBedStartsTheJobThatWaitsForIt) {
  EXPECT_EQ(starts(at("clear", "real")), 1);
  EXPECT_FALSE(shop_.store_->printer("real").bed_clear) << "it is only told";
  EXPECT_EQ(told_.at("name"), "a.stl");
  EXPECT_EQ(told_.at("printer"), "real");
  EXPECT_EQ(told_.at("time_s"), 60);
  EXPECT_EQ(told_.at("doubt"), nullptr);
  EXPECT_EQ(does_start(at("clear", "real"), "real", 1), 1);
}

TEST_F(Starts, AnotherJobThanTheOneThatWasAskedAboutIsToldAnew) {
  ready("real");
  shop_.job_manager_->cancel(1);
  json request = at("clear", "real");
  request["starts"] = 1;
  EXPECT_EQ(shop_.ask(request).at("error").at("starts").at("job"), 2);
  EXPECT_TRUE(shop_.ask(at("clear", "real")).at("ok")) << "who says nothing of it is not asked";
}

TEST_F(Starts, NothingStartsWhileSomethingElseIsWaitedFor) {
  EXPECT_EQ(starts(at("pause", "real")), 0);
  EXPECT_EQ(starts(at("clear", "real")), 0) << "paused";
  EXPECT_EQ(starts(of_job("hold", 1)), 0);
  EXPECT_EQ(starts(at("resume", "real")), 0) << "held";
  EXPECT_EQ(does_start(of_job("approve", 1), "real", 1), 1) << "the end of the hold";
  ready("real");
  EXPECT_EQ(shop_.ask(at("clear", "real")).at("error").at("fault"), 75) << "it is printing";
  EXPECT_EQ(starts(at("resume", "real")), 0);
}

TEST_F(Starts, ResumingStartsWhatIsApproved) {
  shop_.job_manager_->pause("real", true);
  EXPECT_EQ(starts(at("clear", "real")), 0);
  EXPECT_EQ(starts(at("resume", "real")), 1);
  EXPECT_EQ(does_start(at("resume", "real"), "real", 1), 1);
}

TEST_F(Starts, ApprovingStartsWhereTheBedIsClear) {
  ready("sim", 1, false);
  EXPECT_EQ(starts(of_job("approve", 2)), 2);
  EXPECT_EQ(told_.at("doubt"), "packing does not pay");
  EXPECT_EQ(does_start(of_job("approve", 2), "sim", 2), 2);
  ready("sim", 1, false);
  EXPECT_EQ(starts(of_job("approve", 3)), 0) << "the printer is printing";
  ready("hand");
  EXPECT_EQ(starts(of_job("approve", 4)), 0) << "what is handed over is not printed";
}

TEST_F(Starts, AgainStartsWhatWasApprovedAndNothingElse) {
  ready("sim", 1, false);
  shop_.job_manager_->cancel(2);
  EXPECT_EQ(starts(of_job("again", 2)), 0) << "it waits for approval";
  EXPECT_EQ(does_start(of_job("approve", 3), "sim", 3), 3);
  end(3);
  EXPECT_EQ(starts(of_job("again", 3)), 3);
  EXPECT_EQ(shop_.store_->find(4), std::nullopt) << "it is only told";
  EXPECT_EQ(does_start(of_job("again", 3), "sim", 3), 4);
}

TEST_F(Starts, WhatWasPutFirstStartsFirst) {
  ready("real");
  ready("real");
  shop_.job_manager_->put_first(3);
  EXPECT_EQ(starts(at("clear", "real")), 3);
  EXPECT_EQ(does_start(at("clear", "real"), "real", 3), 3);
}

TEST_F(Starts, LaterTraysGoBeforeOtherJobs) {
  shop_.job_manager_->cancel(1);
  ready("real");
  ready("real", 2);
  shop_.job_manager_->hold(2);
  EXPECT_EQ(does_start(at("clear", "real"), "real", 3), 3);
  end(3);
  shop_.job_manager_->approve(2);
  EXPECT_EQ(starts(at("clear", "real")), 3);
  EXPECT_EQ(told_.at("tray"), 2);
  EXPECT_EQ(told_.at("trays"), 2);
  EXPECT_EQ(does_start(at("clear", "real"), "real", 3), 3);
}

}  // namespace
}  // namespace packmerger
