// What Marlins do in the middle of a print, each trap that real firmware was seen to set, in
// simulated time.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "firmware_io/simulated/marlin.h"
#include "sim/programs.h"
#include "sim/scenario.h"

namespace packmerger::test {
namespace {

using simulated::Marlin;
using simulated::MarlinTraits;
using simulated::Pace;
using ::testing::HasSubstr;

TEST(Marlin, PrintsAndProvesIt) {
  Marlin firmware(Pace{1, false});
  FaultyPort port(firmware);
  PrintControl control;
  std::vector<PrintState> states;
  const auto failure =
      print(port, true, joined(gcode_program(30)), control, [&](const PrintReport& report) {
        if (states.empty() || states.back() != report.state) states.push_back(report.state);
      });
  EXPECT_FALSE(failure) << failure->what();
  const std::vector<PrintState> expected = {PrintState::kConnecting, PrintState::kPrinting,
                                            PrintState::kHeating, PrintState::kPrinting,
                                            PrintState::kDone};
  EXPECT_EQ(states, expected);
  std::vector<std::string> executed = {"M115", "M27", "M110 N0", "M155 S2"};
  for (const std::string& line : gcode_program(30)) executed.push_back(line);
  executed.insert(executed.end(), {"M400", "M114", "M155 S0"});
  EXPECT_EQ(port.executed(), executed);
}

// In the midst of the moves.
constexpr std::size_t kLine = 40;

// Behind a failure nothing of the program follows: after a reset not a byte, otherwise the safe
// text.
void expect_end_after(const std::function<void(Marlin&)>& event, const std::string& cause,
                      const std::string& safe, const std::string& trait = "") {
  MarlinTraits traits;
  ASSERT_TRUE(trait.empty() || set_trait(traits, trait)) << trait;
  Marlin firmware(Pace{1, true}, traits);
  FaultyPort port(firmware);
  std::size_t sent_before = 0;
  port.on_step = [&](std::size_t written) {
    if (written != kLine || sent_before != 0) return;
    sent_before = port.sent.size();
    if (event) event(firmware);
  };
  PrintControl control;
  const auto failure = print(port, true, joined(gcode_program(60)), control);
  ASSERT_TRUE(failure);
  EXPECT_EQ(failure->fault(), Fault::kIo);
  EXPECT_THAT(failure->what(), HasSubstr(cause));
  // The line that was on its way when it happened is the last of the program.
  EXPECT_LT(port.sent.size(), sent_before + 96 + safe.size()) << port.sent.substr(sent_before);
  EXPECT_EQ(port.sent.find("\nM104 S0\n") != std::string::npos, !safe.empty());
  EXPECT_THAT(port.sent, ::testing::EndsWith(safe));
}

const std::string kSafe = "M104 S0\nM140 S0\nM155 S0\n";

TEST(Marlin, ResetEndsThePrint) {
  expect_end_after([](Marlin& marlin) { marlin.reset(); }, "reset", "");
}

TEST(Marlin, FailedHeaterEndsThePrint) {
  expect_end_after([](Marlin& marlin) { marlin.fail_heater(); }, "Thermal Runaway", kSafe);
}

TEST(Marlin, AStopEndsThePrintAndHeatersAreTurnedOff) {
  const auto at = [](const char* trait) { return std::string(trait) + std::to_string(kLine); };
  expect_end_after({}, "restart with M999", kSafe, at("stops_at="));
  expect_end_after({}, "fatal: Heater/sensor error", kSafe, at("fatal_at="));
  expect_end_after({}, "!! Move out of range", kSafe, at("refuses_at="));
}

TEST(Marlin, CancelWhileHeatingActsWithinASecond) {
  Marlin firmware(Pace{1, false});
  FaultyPort port(firmware);
  PrintControl control;
  double asked_at_s = 0;
  port.on_step = [&](std::size_t) {
    if (asked_at_s == 0 && port.now_s() > 5) {
      asked_at_s = port.now_s();
      control.cancel();
    }
  };
  const auto failure = print(port, true, joined(gcode_program(30)), control);
  ASSERT_TRUE(failure);
  EXPECT_EQ(failure->fault(), Fault::kInterrupted);
  EXPECT_LT(port.now_s() - asked_at_s, 1);
  const auto& executed = port.executed();
  EXPECT_EQ(count(executed, "M104 S0"), 1u);
  EXPECT_EQ(count(executed, "M140 S0"), 1u);
  EXPECT_EQ(count(executed, "G28 W"), 0u);
}

TEST(Marlin, AsksItsUserAndGoesOn) {
  Marlin firmware(Pace{1, false});
  FaultyPort port(firmware);
  PrintControl control;
  std::string question;
  const auto failure =
      print(port, true, "G28\nM0 Change tool\nM84\n", control, [&](const PrintReport& report) {
        if (report.state != PrintState::kWaiting) return;
        question = report.text;
        control.answer(0);
      });
  EXPECT_FALSE(failure) << failure->what();
  EXPECT_EQ(question, "Change tool");
  EXPECT_EQ(count(port.executed(), "M84"), 1u);
}

TEST(Marlin, PausesAreRefusedWhereNobodyCanBeAsked) {
  MarlinTraits traits;
  traits.prompts = false;
  Marlin firmware(Pace{1, false}, traits);
  FaultyPort port(firmware);
  PrintControl control;
  const auto failure = print(port, true, "G28\nM0\n", control);
  ASSERT_TRUE(failure);
  EXPECT_EQ(failure->fault(), Fault::kUnavailable);
  EXPECT_EQ(count(port.executed(), "G28"), 0u);
}

TEST(Marlin, TenRequestsForOneLineEndThePrint) {
  Parrot firmware([](const std::string& line) {
    return line.rfind("N5 ", 0) == 0 ? "Resend: 5\nok\n" : polite(line);
  });
  FaultyPort port(firmware);
  PrintControl control;
  const auto failure = print(port, true, joined(gcode_program(30)), control);
  ASSERT_TRUE(failure);
  EXPECT_THAT(failure->what(), HasSubstr("asked ten times for line 5"));
  EXPECT_EQ(port.executed().back(), "M140 S0") << "the safe text is still sent";
}

// Some firmwares send no ok behind a Resend.
TEST(Marlin, ResendWithoutOk) {
  bool asked = false;
  Parrot firmware([&](const std::string& line) {
    if (line.rfind("N5 ", 0) == 0 && !std::exchange(asked, true)) return std::string("Resend:5\n");
    return line.find("M114") == std::string::npos ? polite(line) : "X:0 Y:0 Z:0 E:0\nok\n";
  });
  FaultyPort port(firmware);
  PrintControl control;
  const auto failure = print(port, true, joined(gcode_program(30)), control);
  EXPECT_FALSE(failure) << failure->what();
}

TEST(Marlin, SilenceEndsThePrintInTime) {
  Parrot firmware([](const std::string& line) {
    const bool asks = line.find("M105") != std::string::npos;
    return line.starts_with("N9 ") || asks ? std::string() : polite(line);
  });
  FaultyPort port(firmware);
  PrintControl control;
  const auto failure = print(port, true, joined(gcode_program(30)), control);
  ASSERT_TRUE(failure);
  EXPECT_THAT(failure->what(), HasSubstr("has not answered line 9"));
  EXPECT_LT(port.now_s(), 35);
}

TEST(Marlin, OwnCardIsBusy) {
  Parrot firmware([](const std::string& line) {
    return line == "M27" ? std::string("SD printing byte 12/3000\nok\n") : polite(line);
  });
  FaultyPort port(firmware);
  PrintControl control;
  const auto failure = print(port, true, "G28\n", control);
  ASSERT_TRUE(failure);
  EXPECT_EQ(failure->fault(), Fault::kBusy);
}

// A printer that was told to report its temperatures goes on with it whatever else it says.
class Thermometer : public simulated::Firmware {
 public:
  void receive(std::string_view, double) override {}
  void advance(double now_s) override {
    if (now_s < next_s_) return;
    output_ += " T:21.00 /0.00 B:21.00 /0.00 @:0 B@:0\n";
    next_s_ = now_s + 1;
  }
  double next_event_s() const override { return next_s_; }

 private:
  double next_s_ = 0;
};

TEST(Marlin, ReportsAloneAreNoAnswer) {
  Thermometer firmware;
  FaultyPort port(firmware);
  PrintControl control;
  const auto failure = print(port, true, "G28\n", control);
  ASSERT_TRUE(failure);
  EXPECT_EQ(failure->fault(), Fault::kUnavailable);
  EXPECT_LT(port.now_s(), 60);
}

// Reports of the temperature go on when the ok of the heating command got lost.
TEST(Marlin, ALostOkWhileHeatingIsNoticedInSpiteOfReports) {
  MarlinTraits traits;
  traits.reports_unasked = true;
  Marlin firmware(Pace{1, true}, traits);
  FaultyPort port(firmware);
  lose_answers_behind(port, 6);  // M115, M27 and M110 take four chunks; then come M104 and M190
  PrintControl control;
  const auto failure = print(port, true, joined(gcode_program(20)), control);
  EXPECT_FALSE(failure) << failure->what();
  EXPECT_EQ(only(port.executed(), gcode_program(20)), gcode_program(20));
  EXPECT_LT(port.now_s(), 60);
}

TEST(Marlin, AnEarlyResetIsNoticedEvenWhenItsFirstWordsAreLost) {
  Marlin firmware(Pace{1, true});
  FaultyPort port(firmware);
  bool done = false;
  port.on_step = [&](std::size_t written) {
    if (written == 10 && !std::exchange(done, true)) {
      firmware.reset();
      firmware.take_output();
    }
  };
  PrintControl control;
  const auto failure = print(port, true, joined(gcode_program(20)), control);
  ASSERT_TRUE(failure);
  EXPECT_THAT(failure->what(), HasSubstr("it was probably reset"));
  const auto executed = only(port.executed(), gcode_program(20));
  EXPECT_EQ(count(executed, "M104 S199"), 1U) << "nothing is executed again";
}

// As Repetier's firmware: what is not numbered it asks for, whoever needs the heaters off.
TEST(Marlin, ATextWithoutNumbersThatIsRefusedComesNumbered) {
  simulated::MarlinTraits traits;
  traits.refuses_raw = true;
  traits.fatal_at = 20;
  simulated::Marlin firmware(simulated::Pace{1, true}, traits);
  FaultyPort port(firmware);
  PrintControl control;
  std::string program = "M104 S200\n";
  for (int i = 1; i <= 40; ++i) program += "G1 X" + std::to_string(i) + "\n";
  const auto failure = print(port, true, program, control);
  ASSERT_TRUE(failure);
  EXPECT_THAT(failure->what(), ::testing::HasSubstr("fatal:"));
  EXPECT_GE(count(port.executed(), "M104 S0"), 1u);
  EXPECT_GE(count(port.executed(), "M140 S0"), 1u);
}

}  // namespace
}  // namespace packmerger::test
