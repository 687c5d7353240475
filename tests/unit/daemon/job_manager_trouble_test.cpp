// What fails again and again is told once, and again when it changes or ends.
#include <gtest/gtest.h>

#include "base/time/wall_clock.h"
#include "workshop.h"

namespace packmerger {
namespace {

int times(const std::string& text, const std::string& part) {
  int count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1))
    ++count;
  return count;
}

SendEnded not_started(const std::string& why) {
  SendEnded ended;
  ended.job = 1;
  ended.outcome = SendOutcome::kNotStarted;
  ended.failure = {Fault::kUnavailable, why, "switch it on"};
  return ended;
}

class TroubleTest : public testing::Test {
 protected:
  TroubleTest() {
    shop_.drop("sim", "a.stl");
    shop_.prepare(*shop_.prepare_order());
  }
  // Each try comes later than the one before it.
  void fail(const std::string& why) {
    ASSERT_TRUE(shop_.send_order("sim"));
    shop_.tell(not_started(why));
    shop_.job_manager_->advance(shop_.now_s_ += 1000);
  }

  Workshop shop_;
};

TEST_F(TroubleTest, APrinterThatCannotBeReachedIsToldOnce) {
  for (int i = 0; i < 5; ++i) fail("nobody answers");
  EXPECT_EQ(times(shop_.log_, "nobody answers"), 1) << shop_.log_;
  EXPECT_EQ(times(shop_.log_, "sending tray"), 1) << shop_.log_;
  fail("another printer is there");
  fail("another printer is there");
  EXPECT_EQ(times(shop_.log_, "another printer is there"), 1) << "it changed";
  SendProgress waiting = progress_of(1, PrintState::kWaiting);
  waiting.report.done = 0;
  shop_.tell(waiting);
  EXPECT_EQ(times(shop_.log_, "started after all"), 0) << "nothing was sent yet";
  shop_.tell(progress_of(1, PrintState::kPrinting));
  EXPECT_EQ(times(shop_.log_, "started after all"), 1) << "it is over";
  EXPECT_EQ(shop_.view(1).at("status"), "printing 50 %");
}

TEST_F(TroubleTest, IsSeenWithTheJobWhileItWaits) {
  ASSERT_TRUE(shop_.send_order("sim"));
  shop_.tell(not_started("nobody answers"));
  EXPECT_EQ(shop_.view(1).at("status"), "waits to be sent (nobody answers)");
  shop_.job_manager_->cancel(1);
  EXPECT_EQ(shop_.view(1).at("status"), "cancelled") << "nothing of it once the job ended";
}

TEST_F(TroubleTest, IsOneLineOfHistoryAndOneNoticeHoweverOftenItIsTried) {
  const auto notes = [&] {
    std::vector<std::string> told;
    for (const JobEvent& event : shop_.store_->history(1))
      told.push_back(std::string(state_name(event.state)) + ": " + event.note);
    return told;
  };
  const std::size_t before = notes().size();
  int notices = 0;
  shop_.store_->listen([&](const JobRecord&, std::string_view) { ++notices; });
  for (int i = 0; i < 5; ++i) fail(i % 2 == 0 ? "nobody answers" : "another printer is there");
  EXPECT_EQ(notices, 2) << "each reason once, though they take turns";
  const auto restart = [&] {  // while it is tried
    shop_.job_manager_->stop();
    shop_.send_order("sim");
    shop_.tell(not_started("Cancelled"));
    shop_.start();
  };
  restart();
  const double since_s = shop_.view(1).at("trouble").at("since_s");
  for (int i = 0; i < 3; ++i) fail("nobody answers");
  restart();
  fail("nobody answers");
  const json trouble = shop_.view(1).at("trouble");
  EXPECT_EQ(trouble.at("what"), "nobody answers");
  EXPECT_EQ(trouble.at("tries"), 9);
  EXPECT_EQ(trouble.at("since_s"), since_s) << "a restart does not end it";
  EXPECT_EQ(shop_.view(1).at("status"), "connecting 0 % (nobody answers, tried 9 times)");
  EXPECT_EQ(shop_.view(1).at("state"), "sending") << "the state is as it is";
  EXPECT_EQ(notes().size(), before + 2);
  shop_.tell(progress_of(1, PrintState::kPrinting));
  shop_.tell(progress_of(1, PrintState::kPrinting));
  EXPECT_EQ(notes().size(), before + 3);
  EXPECT_EQ(notes().back(), "sending: started after 9 tries in vain");
  EXPECT_EQ(shop_.view(1).at("trouble"), nullptr);
}

TEST_F(TroubleTest, IsSeenWithItsPrinterAsThatOfItsFoldersIs) {
  const auto at = [&](std::size_t number) {
    return shop_.ask({{"verb", "printers.list"}}).at("result").at(number);
  };
  fail("nobody answers");
  shop_.tell(FolderTold{"sim", shop_.config_.printer("sim")->folder,
                        Trouble{"its folder is not there", 5, 3, 9}, 2});
  const json told = at(2).at("troubles");
  ASSERT_EQ(told.size(), 2U);
  EXPECT_EQ(told.at(0), json({{"about", "folder"},
                              {"what", "its folder is not there (and 2 more)"},
                              {"since_s", 5},
                              {"tries", 3},
                              {"next_s", 9}}));
  EXPECT_EQ(told.at(1).at("about"), "printer");
  EXPECT_EQ(told.at(1).at("what"), "nobody answers");
  EXPECT_EQ(at(2).at("trouble"), "its folder is not there (and 2 more); nobody answers");
  EXPECT_EQ(at(1).at("trouble"), nullptr);
  shop_.drop("hand", "b.stl");
  shop_.prepare(shop_.prepare_order().value());
  shop_.job_manager_->approve(2);
  shop_.job_manager_->advance(shop_.now_s_);
  ASSERT_TRUE(shop_.send_order("hand"));
  SendEnded ended = not_started("share/ is no folder that can be written to");
  ended.job = 2;
  shop_.tell(ended);
  EXPECT_EQ(at(0).at("troubles").at(0).at("about"), "handoff_folder");
  EXPECT_NEAR(at(0).at("troubles").at(0).at("next_s"), unix_now_s() + 10, 5);
  shop_.tell(FolderTold{"sim", shop_.config_.printer("sim")->folder,
                        Trouble{"its folder is not there", 5, 4, 99}, 3});
  EXPECT_EQ(times(shop_.log_, "its folder is not there"), 1) << "however many files, and tries";
}

TEST_F(TroubleTest, OfAFolderThatIsThePrintersNoMoreIsNotTaken) {
  const Trouble trouble{"its folder is not there", 5, 3, 9};
  shop_.tell(FolderTold{"sim", shop_.config_.printer("real")->folder, trouble, 0});
  shop_.tell(FolderTold{"gone", shop_.config_.printer("sim")->folder, trouble, 0});
  EXPECT_TRUE(shop_.job_manager_->troubles_at(*shop_.config_.printer("sim")).empty());
}

TEST_F(TroubleTest, TellsWhenItIsTriedNext) {
  ASSERT_TRUE(shop_.send_order("sim"));
  shop_.tell(not_started("nobody answers"));
  const auto next = [&] { return shop_.view(1).at("trouble").at("next_s"); };
  EXPECT_NEAR(next(), unix_now_s() + 10, 5);
  shop_.job_manager_->hold(1);
  EXPECT_EQ(next(), nullptr) << "nobody tries";
  shop_.job_manager_->cancel(1);
  EXPECT_EQ(shop_.view(1).at("trouble"), nullptr);
}

}  // namespace
}  // namespace packmerger
