// What becomes of the questions that a printer asks while it stands paused.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "firmware_io/simulated/marlin.h"
#include "sim/programs.h"
#include "sim/scenario.h"

namespace packmerger::test {
namespace {

using simulated::Marlin;
using simulated::Pace;
using ::testing::HasSubstr;

constexpr double kAsks_s = 100;  // in the middle of the moves
constexpr double kAnswered_s = kAsks_s + 3600;

// A print whose printer asks after a while, and whose people come an hour later.
class Questions : public ::testing::Test {
 protected:
  void print(const std::function<void()>& asks, const std::function<void()>& people) {
    bool asked = false;
    bool came = false;
    port.on_step = [&](std::size_t) {
      if (port.now_s() > kAsks_s && !std::exchange(asked, true)) asks();
      if (port.now_s() > kAnswered_s && !std::exchange(came, true)) people();
    };
    const auto failure =
        test::print(port, true, joined(program), control, [&](const PrintReport& report) {
          last = report;
          if (report.text == "Paused") control.answer(1);  // no more is to be purged
        });
    ASSERT_FALSE(failure) << failure->what();
    EXPECT_TRUE(came);
    EXPECT_EQ(only(port.executed(), program), program);
  }

  std::size_t temperatures_asked() const {
    std::size_t times = 0;
    for (std::size_t at = 0; (at = port.sent.find("M105\n", at)) != std::string::npos; ++at)
      ++times;
    return times;
  }

  Marlin firmware{Pace{1, false}};
  FaultyPort port{firmware};
  PrintControl control;
  PrintReport last;
  std::vector<std::string> program = gcode_program(3000);
};

// Asks once, in line 2, and then loads filament for twenty seconds without a word but "busy".
class Loader : public simulated::Firmware {
 public:
  explicit Loader(int deaf) : deaf_(deaf) {}  // to so many answers
  int answers = 0;

  void receive(std::string_view bytes, double now_s) override {
    for (const char c : bytes) {
      if (c != '\n')
        line_ += c;
      else if (!line_.empty())
        take(std::exchange(line_, {}), now_s);
    }
  }
  void advance(double now_s) override {
    if (now_s >= next_busy_s_) {
      output_ += asks_ ? "echo:busy: paused for user\n" : "echo:busy: processing\n";
      next_busy_s_ = now_s + 2;
    }
    if (now_s < loaded_s_) return;
    output_ += "ok\nok\n";  // M600 and M876
    loaded_s_ = next_busy_s_ = simulated::kNever;
  }
  double next_event_s() const override { return std::min(next_busy_s_, loaded_s_); }

 private:
  void take(const std::string& line, double now_s) {
    if (line.starts_with("N2 ")) {
      output_ += "//action:prompt_begin Parked\n//action:prompt_button Continue\n";
      asks_ = true;
      next_busy_s_ = now_s + 2;
    } else if (line.starts_with("M876")) {
      if (++answers <= deaf_) return;
      if (std::exchange(asks_, false)) loaded_s_ = now_s + 20;
    } else if (line.find("M114") != std::string::npos) {
      output_ += "X:0 Y:0 Z:0 E:0\nok\n";
    } else if (line == "M115") {
      output_ += "FIRMWARE_NAME:Loader\nCap:EMERGENCY_PARSER:1\nok\n";
    } else if (next_busy_s_ == simulated::kNever) {
      output_ += "ok\n";
    }
  }

  int deaf_;
  bool asks_ = false;
  double next_busy_s_ = simulated::kNever;
  double loaded_s_ = simulated::kNever;
  std::string line_;
};

// Whoever answers whatever is shown answers once; where the answer got lost, it is asked again.
TEST(AnsweredQuestions, AreShownNoLongerUnlessThePrinterStillWaits) {
  for (const int deaf : {0, 1}) {
    Loader loader(deaf);
    FaultyPort line(loader);
    PrintControl person;
    const auto failure =
        print(line, true, "G21\nM600\nG1 X1\n", person, [&](const PrintReport& report) {
          if (report.state == PrintState::kWaiting && !report.choices.empty()) person.answer(0);
        });
    EXPECT_FALSE(failure) << failure->what();
    EXPECT_EQ(loader.answers, deaf + 1);
  }
}

TEST_F(Questions, ComeBackInAPauseWhereTheAnswerGotLost) {
  int step = 0;
  const auto at = [&](double seconds, int number) {
    return port.now_s() > seconds && step == number && ++step != 0;
  };
  port.on_step = [&](std::size_t) {
    if (at(kAsks_s, 0)) firmware.run_out();
    if (at(kAnswered_s, 1)) control.answer(0);
    if (at(kAnswered_s + 3, 2)) {
      EXPECT_EQ(last.state, PrintState::kPaused);
    }
    if (at(kAnswered_s + 30, 3)) {
      EXPECT_EQ(last.state, PrintState::kWaiting);
      EXPECT_EQ(last.text, "Nozzle Parked");
      EXPECT_EQ(last.choices, std::vector<std::string>{"Continue"});
      control.answer(0);
    }
  };
  bool lost = false;
  port.on_send = [&](std::string& bytes) {
    if (bytes.starts_with("M876") && !std::exchange(lost, true)) bytes.clear();
  };
  const auto failure =
      test::print(port, true, joined(program), control, [&](const PrintReport& report) {
        last = report;
        if (report.text == "Paused") control.answer(1);
      });
  EXPECT_FALSE(failure) << failure->what();
  EXPECT_EQ(step, 4);
  EXPECT_EQ(only(port.executed(), program), program);
}

TEST_F(Questions, AreNotHiddenByAPause) {
  print(
      [&] {
        firmware.tell_host("prompt_begin Heater Timeout");
        firmware.tell_host("prompt_button Reheat");
        firmware.tell_host("prompt_show");
        firmware.tell_host("paused");
      },
      [&] {
        EXPECT_EQ(last.state, PrintState::kWaiting);
        EXPECT_EQ(last.text, "Heater Timeout");
        EXPECT_EQ(last.choices, std::vector<std::string>{"Reheat"});
        control.answer(0);
        firmware.tell_host("resumed");
      });
  EXPECT_THAT(port.sent, HasSubstr("M876 S0\n"));
}

// Without answers to choose from the printer stands paused and says why.
TEST_F(Questions, WithoutAnswersAreToldWithThePause) {
  print(
      [&] {
        firmware.tell_host("prompt_begin Filament Runout");
        firmware.tell_host("prompt_show");
        firmware.tell_host("pause");
      },
      [&] {
        EXPECT_EQ(last.state, PrintState::kPaused);
        EXPECT_EQ(last.text, "Filament Runout");
        firmware.tell_host("resume");
      });
}

// The filament has run out: the printer changes it by itself, says that it is busy, and reads
// nothing of what it is sent.
TEST_F(Questions, WhatABusyPrinterDoesNotReadDoesNotPileUp) {
  std::size_t asked_before = 0;
  print(
      [&] {
        firmware.run_out();
        asked_before = temperatures_asked();
      },
      [&] {
        EXPECT_EQ(last.text, "Nozzle Parked");
        EXPECT_LE(temperatures_asked() - asked_before, 2u);
        control.answer(0);
      });
}

// An hour passes in a pause before the printer says for the first time that it is busy.
TEST_F(Questions, DoNotMakeASilentPrinterSeemAliveForHours) {
  constexpr double kDies_s = kAnswered_s + 600;
  int step = 0;
  const auto at = [&](double seconds, int number) {
    return port.now_s() > seconds && step == number && ++step != 0;
  };
  port.on_step = [&](std::size_t) {
    if (at(kAsks_s, 0)) control.pause();
    if (at(kAnswered_s, 1)) firmware.run_out();
    if (at(kAnswered_s + 60, 2)) control.answer(0);
    if (at(kAnswered_s + 120, 3)) control.resume();
    if (at(kDies_s, 4)) port.lose_answers = true;
  };
  program = gcode_program(30000);
  const auto failure =
      test::print(port, true, joined(program), control, [&](const PrintReport& report) {
        if (report.text == "Paused") control.answer(1);
      });
  ASSERT_TRUE(failure);
  EXPECT_EQ(step, 5);
  EXPECT_LT(port.now_s(), kDies_s + 1800);
}

}  // namespace
}  // namespace packmerger::test
