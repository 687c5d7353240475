// Finished prints teach how long a printer really takes.
#include <gtest/gtest.h>

#include "unit/daemon/workshop.h"

namespace packmerger {
namespace {

SendEnded printed(std::int64_t job, double printed_s, double paused_s = 0) {
  return {job, SendOutcome::kDone, {}, "", printed_s, paused_s};
}

// Prints a model, predicted to take 60 s, on the simulated printer.
std::int64_t print(Workshop& shop, double printed_s, double paused_s = 0) {
  shop.drop("sim", "a.stl");
  shop.prepare(shop.prepare_order().value());
  const std::int64_t job = shop.send_order("sim")->job;
  shop.tell(printed(job, printed_s, paused_s));
  return job;
}

json printer_view_of(Workshop& shop) {
  const json printers = shop.ask({{"verb", "printers.list"}}).at("result");
  for (const json& printer : printers)
    if (printer.at("name") == "sim") return printer;
  return {};
}

TEST(Corrections, AreShownBesideTheEstimateOnceThreePrintsTaughtThem) {
  Workshop shop;
  const std::int64_t first = print(shop, 66);
  print(shop, 66, 10);
  EXPECT_TRUE(shop.view(first).at("correction").is_null());
  EXPECT_TRUE(printer_view_of(shop).at("corrections").empty());
  print(shop, 66);
  const json correction = shop.view(first).at("correction");
  EXPECT_NEAR(correction.at("factor"), 1.1, 1e-9);
  EXPECT_LT(correction.at("low"), 1.1);
  EXPECT_GT(correction.at("high"), 1.1);
  EXPECT_EQ(correction.at("prints"), 3);
  EXPECT_EQ(printer_view_of(shop).at("corrections").at(0), correction);
  EXPECT_EQ(shop.view(first).at("predicted_s"), 60) << "the estimate itself stays as it was";
  EXPECT_EQ(shop.view(first).at("printed_s"), 66);
  EXPECT_EQ(shop.view(2).at("paused_s"), 10);
}

TEST(Corrections, AreNotTaughtByCancelledFailedOrLongPausedPrints) {
  Workshop shop;
  print(shop, 66);
  print(shop, 66);
  print(shop, 66, 7200);
  for (const SendOutcome outcome : {SendOutcome::kCancelled, SendOutcome::kFailed}) {
    shop.drop("sim", "a.stl");
    shop.prepare(shop.prepare_order().value());
    SendEnded end{shop.send_order("sim")->job, outcome, {Fault::kIo, "x", "y"}, ""};
    end.printed_s = 66;
    shop.tell(end);
  }
  EXPECT_TRUE(printer_view_of(shop).at("corrections").empty());
  print(shop, 66);
  EXPECT_EQ(printer_view_of(shop).at("corrections").size(), 1U);
}

TEST(Corrections, TraysAddUpThroughARestart) {
  Workshop shop;
  shop.job_manager_->clear("real");
  shop.drop("real", "a.stl");
  shop.prepare(shop.prepare_order().value(), 2);
  shop.tell(printed(shop.send_order("real")->job, 40, 5));
  shop.start();
  shop.job_manager_->clear("real");
  shop.job_manager_->advance(shop.now_s_);
  shop.tell(printed(shop.send_order("real")->job, 50, 6));
  EXPECT_EQ(shop.job(1).state, JobState::kDone);
  EXPECT_DOUBLE_EQ(shop.job(1).printed_s, 90);
  EXPECT_DOUBLE_EQ(shop.job(1).paused_s, 11);
}

TEST(Corrections, APrintAgainTeachesToo) {
  Workshop shop;
  for (int i = 0; i < 2; ++i) print(shop, 90);
  const JobRecord again = shop.job_manager_->again(1);
  shop.job_manager_->advance(shop.now_s_);
  shop.send_order("sim");
  shop.tell(printed(again.id, 90));
  EXPECT_NEAR(printer_view_of(shop).at("corrections").at(0).at("factor"), 1.5, 1e-9);
  EXPECT_EQ(shop.job(again.id).printed_s, 90) << "not the old job's time too";
}

}  // namespace
}  // namespace packmerger
