#include "daemon/workers/print_clock.h"

#include <gtest/gtest.h>

namespace packmerger {
namespace {

TEST(PrintClock, PausesAndConnectingDoNotCount) {
  PrintClock clock;
  clock.report(PrintState::kConnecting, 100);
  clock.report(PrintState::kHeating, 110);
  clock.report(PrintState::kPrinting, 200);
  clock.report(PrintState::kPaused, 260);
  clock.report(PrintState::kPaused, 1000);
  clock.report(PrintState::kPrinting, 1260);
  clock.report(PrintState::kWaiting, 1300);
  clock.report(PrintState::kPrinting, 1350);
  clock.end(1400);
  EXPECT_DOUBLE_EQ(clock.printed_s(), 90 + 60 + 40 + 50);
  EXPECT_DOUBLE_EQ(clock.paused_s(), 1000 + 50);
}

TEST(PrintClock, WithoutAnAnswerNothingWasPrinted) {
  PrintClock clock;
  clock.report(PrintState::kConnecting, 1);
  clock.end(50);
  EXPECT_EQ(clock.printed_s(), 0);
  EXPECT_EQ(clock.paused_s(), 0);
}

}  // namespace
}  // namespace packmerger
