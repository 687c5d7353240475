// What fails again and again is told once, and again when it changes or ends.
#include <gtest/gtest.h>

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

class Trouble : public testing::Test {
 protected:
  Trouble() {
    shop_.drop("sim", "a.stl");
    shop_.prepare(*shop_.prepare_order());
  }
  // Each try comes later than the one before it.
  void fail(const std::string& why) {
    ASSERT_TRUE(shop_.send_order("sim"));
    shop_.tell(not_started(why));
    shop_.foreman_->advance(shop_.now_s_ += 1000);
  }

  Workshop shop_;
};

TEST_F(Trouble, APrinterThatCannotBeReachedIsToldOnce) {
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

TEST_F(Trouble, IsSeenWithTheJobWhileItWaits) {
  ASSERT_TRUE(shop_.send_order("sim"));
  shop_.tell(not_started("nobody answers"));
  EXPECT_EQ(shop_.view(1).at("status"), "waits to be sent (nobody answers)");
  shop_.foreman_->cancel(1);
  EXPECT_EQ(shop_.view(1).at("status"), "cancelled") << "nothing of it once the job ended";
}

}  // namespace
}  // namespace packmerger
