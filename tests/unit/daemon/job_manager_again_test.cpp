// Printing again: what nobody approved asks, and no order outlives the daemon that took it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "unit/daemon/workshop.h"

namespace packmerger {
namespace {

// A job that was prepared, with a doubt or without, and cancelled before anything else.
JobRecord cancelled(Workshop& shop, const std::string& printer, bool pays) {
  shop.drop(printer, "a.stl");
  shop.job_manager_->hold(shop.prepare_order().value().job);
  const std::int64_t id = shop.store_->open_jobs().rbegin()->first;
  PrepareOrder order;
  order.job = id;
  order.out = shop.job(id).folder;
  shop.prepare(order, 1, pays);
  return shop.job_manager_->cancel(id);
}

TEST(Again, WhatNobodyApprovedComesBackWithItsDoubt) {
  for (const std::string printer : {"sim", "hand"}) {
    Workshop shop;
    const JobRecord old = cancelled(shop, printer, false);
    const JobRecord again = shop.job_manager_->again(old.id);
    shop.job_manager_->advance(shop.now_s_);
    EXPECT_FALSE(shop.send_order(printer));
    const json view = shop.view(again.id);
    EXPECT_EQ(view.at("state"), "ready");
    EXPECT_EQ(view.at("waits_for"), "approval");
    EXPECT_EQ(view.at("reason"), "packing does not pay");
    EXPECT_EQ(view.at("doubt"), "packing does not pay");
    EXPECT_EQ(view.at("approved"), false);
    shop.job_manager_->cancel(again.id);
    const JobRecord third = shop.job_manager_->again(again.id);
    EXPECT_EQ(third.reason, "packing does not pay") << "nor does another time approve it";
    shop.job_manager_->approve(third.id);
    shop.job_manager_->advance(shop.now_s_);
    EXPECT_TRUE(shop.send_order(printer));
  }
}

TEST(Again, WithoutADoubtTheSettingsDecideAsEver) {
  Workshop shop;
  const JobRecord again = shop.job_manager_->again(cancelled(shop, "hand", true).id);
  shop.job_manager_->advance(shop.now_s_);
  EXPECT_EQ(shop.job(again.id).state, JobState::kReady) << "approve = ask";
  const JobRecord other = shop.job_manager_->again(cancelled(shop, "sim", true).id);
  shop.job_manager_->advance(shop.now_s_);
  EXPECT_EQ(shop.job(other.id).state, JobState::kSending) << "approve = auto";
}

TEST(Again, WhatWasApprovedNeedsNoSecondWord) {
  Workshop shop;
  shop.drop("sim", "a.stl");
  shop.prepare(*shop.prepare_order(), 1, false);
  shop.job_manager_->approve(1);
  shop.job_manager_->advance(shop.now_s_);
  shop.send_order("sim");
  shop.tell(SendEnded{1, SendOutcome::kFailed, {Fault::kIo, "unplugged", "x"}, ""});
  shop.job_manager_->again(1);
  shop.job_manager_->advance(shop.now_s_);
  EXPECT_TRUE(shop.send_order("sim"));
}

// On a printer whose bed a person has to clear.
class Orders : public testing::Test {
 protected:
  Orders() {
    shop_.job_manager_->clear("real");
    shop_.drop("real", "a.stl");
    shop_.prepare(*shop_.prepare_order());
    shop_.send_order("real");
    shop_.tell(SendEnded{1, SendOutcome::kDone, {}, ""});
    shop_.run_the_folder_worker();
  }
  bool starts() {
    shop_.job_manager_->advance(shop_.now_s_);
    return shop_.send_order("real").has_value();
  }

  Workshop shop_;
};

TEST_F(Orders, AgainDoesNotPrintAfterARestart) {
  shop_.job_manager_->again(1);
  EXPECT_FALSE(starts()) << "the bed is not clear";
  shop_.start();
  EXPECT_EQ(shop_.view(2).at("waits_for"), "hold");
  shop_.job_manager_->clear("real");
  EXPECT_FALSE(starts()) << "the order was given to the daemon before this one";
  shop_.job_manager_->approve(2);
  EXPECT_TRUE(starts());
}

TEST_F(Orders, NorDoesAnUploadThatWasToBePrintedAtOnce) {
  shop_.config_.printers[1].approve = Approve::kAsk;
  const fs::path file = shop_.folder_.path() / "b.stl";
  std::ofstream(file) << "b";
  shop_.job_manager_->uploaded({.printer = "real", .name = "b.stl", .file = file, .at_once = true});
  shop_.start();
  shop_.prepare(*shop_.prepare_order());
  shop_.job_manager_->clear("real");
  EXPECT_FALSE(starts());
  EXPECT_EQ(shop_.view(2).at("waits_for"), "approval");
}

TEST_F(Orders, APersonsApprovalLasts) {
  shop_.job_manager_->again(1);
  shop_.job_manager_->hold(2);
  shop_.job_manager_->approve(2);
  shop_.start();
  shop_.job_manager_->clear("real");
  EXPECT_TRUE(starts());
}

}  // namespace
}  // namespace packmerger
