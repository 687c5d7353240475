// A cancel comes to its end, whatever the printer waits for, and is the cause that is told.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "firmware_io/simulated/marlin.h"
#include "sim/programs.h"
#include "sim/scenario.h"

namespace packmerger::test {
namespace {

using simulated::Marlin;
using simulated::Pace;
using ::testing::EndsWith;
using ::testing::HasSubstr;

// Firmware that cannot be interrupted once it has the fifth line.
class Stubborn : public simulated::Firmware {
 public:
  Stubborn(bool says_busy, bool halts) : says_busy_(says_busy), halts_(halts) {}

  void receive(std::string_view bytes, double now_s) override {
    for (const char c : bytes) {
      if (c != '\n') {
        line_ += c;
        continue;
      }
      if (line_.rfind("N5 ", 0) == 0) next_busy_s_ = now_s + 2;
      const bool stuck = next_busy_s_ < simulated::kNever;
      if (line_ == "M112" && halts_) output_ += "Error:Printer halted. kill() called!\n";
      if (!line_.empty() && !stuck) output_ += polite(line_);
      line_.clear();
    }
  }
  void advance(double now_s) override {
    if (now_s < next_busy_s_) return;
    if (says_busy_) output_ += "echo:busy: processing\n";
    next_busy_s_ = now_s + 2;
  }
  double next_event_s() const override { return next_busy_s_; }

 private:
  bool says_busy_;
  bool halts_;
  std::string line_;
  double next_busy_s_ = simulated::kNever;
};

// The print's end when `act` is done at act_s.
std::optional<Error> act_at(FaultyPort& port, const std::string& program, double act_s,
                            PrintControl& control, const std::function<void()>& act,
                            const PrintListener& listener = {}) {
  port.on_step = [&, done = false](std::size_t) mutable {
    if (port.now_s() > act_s && !std::exchange(done, true)) act();
  };
  return print(port, true, program, control, listener);
}

TEST(Cancel, EndsWhateverThePrinterAsksNext) {
  Marlin firmware(Pace{1, false});
  FaultyPort port(firmware);
  PrintControl control;
  std::string shown;
  const auto failure = act_at(
      port, "M104 S200\nM600\nG1 X10\n", 5, control, [&] { control.cancel(); },
      [&](const PrintReport& report) {
        if (report.state == PrintState::kCancelling && !report.text.empty()) shown = report.text;
      });
  ASSERT_TRUE(failure);
  EXPECT_EQ(failure->fault(), Fault::kInterrupted);
  EXPECT_LT(port.now_s(), 15);
  EXPECT_EQ(count(port.executed(), "M104 S0"), 1u);
  EXPECT_EQ(count(port.executed(), "G1 X10"), 0u);
  EXPECT_THAT(shown, HasSubstr("Paused (Continue)"));
}

// A line got lost whose ok came all the same, and the printer asks for it for as long as the pause
// lasts, while its questions take one number after the other. The last request is read when the
// cancel has begun.
TEST(Cancel, InALongPauseExecutesNoOldLine) {
  Marlin firmware(Pace{1, false});
  FaultyPort port(firmware);
  PrintControl control;
  std::string program;
  for (int i = 1; i <= 20; ++i) program += "G1 X" + std::to_string(i) + "\n";
  bool cancelled = false;
  port.on_send = [&](std::string& bytes) {
    port.lose_answers = cancelled && bytes.starts_with("M");  // of M410 and M108
    if (port.now_s() > 100 || bytes.find("G1 X9*") == std::string::npos) return;
    bytes = "G4 P0\n";
    firmware.tell_host("paused");
  };
  port.on_answer = [&](std::string& bytes) {
    if (port.now_s() > 200 && bytes.find("Resend: 9\n") != std::string::npos &&
        !std::exchange(cancelled, true))
      bytes = "//action:cancel\n" + bytes;
  };
  const auto failure = print(port, true, program, control);
  EXPECT_TRUE(cancelled);
  EXPECT_TRUE(failure);
  EXPECT_EQ(count(port.executed(), "G1 X8"), 1u);
  EXPECT_EQ(count(port.executed(), "G1 X9"), 0u);
  EXPECT_GE(count(port.executed(), "M104 S0"), 1u);
}

// While the last moves are waited for, with a line that is none of the program's.
TEST(Cancel, BehindTheProgramsLastLine) {
  Marlin firmware(Pace{1, false});
  FaultyPort port(firmware);
  PrintControl control;
  const auto failure =
      act_at(port, "M104 S0\nG1 X1000 F600\nG1 X0 F600\n", 20, control, [&] { control.cancel(); });
  ASSERT_TRUE(failure);
  EXPECT_EQ(failure->fault(), Fault::kInterrupted);
  EXPECT_LT(port.now_s(), 30);
  EXPECT_EQ(port.executed().back(), "M155 S0");
  EXPECT_EQ(count(port.executed(), "M140 S0"), 1u);
}

TEST(Cancel, ThatCannotEndHaltsThePrinterAndSaysSo) {
  for (const bool halts : {true, false}) {
    Stubborn firmware(true, halts);
    FaultyPort port(firmware);
    PrintControl control;
    const auto failure =
        act_at(port, joined(gcode_program(20)), 5, control, [&] { control.cancel(); });
    ASSERT_TRUE(failure);
    EXPECT_EQ(failure->fault(), Fault::kInterrupted);
    EXPECT_LT(port.now_s(), 70);
    EXPECT_THAT(port.sent, EndsWith("\nM112\n"));
    EXPECT_THAT(failure->what(), HasSubstr("was cancelled"));
    EXPECT_THAT(failure->hint(), HasSubstr(halts ? "off and on" : "heaters may be on"));
  }
}

TEST(Cancel, IsTheCauseThatIsTold) {
  Stubborn firmware(false, false);
  FaultyPort port(firmware);
  PrintControl control;
  const auto failure =
      act_at(port, joined(gcode_program(20)), 5, control, [&] { control.cancel(); });
  ASSERT_TRUE(failure);
  EXPECT_EQ(failure->fault(), Fault::kInterrupted);
  EXPECT_THAT(failure->what(), HasSubstr("The print was cancelled, but"));
  EXPECT_THAT(failure->hint(), HasSubstr("heaters may be on"));
}

TEST(Cancel, WhoLeavesWaitsForNothingButHasTheHeatersTurnedOff) {
  Marlin firmware(Pace{1, false});
  FaultyPort port(firmware);
  PrintControl control;
  const auto failure =
      act_at(port, joined(gcode_program(20)), 5, control, [&] { control.leave(); });
  ASSERT_TRUE(failure);
  EXPECT_EQ(failure->fault(), Fault::kInterrupted);
  EXPECT_LT(port.now_s(), 5.5);
  EXPECT_THAT(port.sent, EndsWith("\nM410\nM108\nM104 S0\nM140 S0\n"));
  EXPECT_THAT(failure->hint(), HasSubstr("heaters may be on"));
  port.leave_alone(10);
  EXPECT_EQ(port.executed().back(), "M140 S0");
}

}  // namespace
}  // namespace packmerger::test
