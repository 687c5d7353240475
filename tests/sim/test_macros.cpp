// Macros of a printer that counts no lines: slow ones, and what is known behind them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sim/uncounted.h"

namespace packmerger::test {
namespace {

using simulated::klipper;
using simulated::Marlin;
using simulated::Pace;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;

// With moves that take three seconds each, the first ones where nobody knows where the head is.
std::vector<std::string> slow_program() {
  std::vector<std::string> program = {"M140 S50", "PRINT_START BED=50", "M83"};
  for (int i = 0; i < 20; ++i) program.push_back("G1 E3." + std::to_string(10 + i) + " F60");
  for (const char* line : {"G28", "G4 S40", "G4 P60000", "M190 S90", "END_PRINT"})
    program.emplace_back(line);
  return program;
}

TEST(Macros, ASlowCommandIsNoLostOne) {
  const std::vector<std::string> program = slow_program();
  for (const auto& traits : {klipper(), rep_rap_firmware(false), rep_rap_firmware(true)})
    for (const std::size_t window : {0U, 96U}) {
      const Outcome seen = outcome(program, {}, "", window, Pace{1, false}, traits);
      EXPECT_FALSE(seen.failure) << seen.failure->what();
      EXPECT_EQ(seen.executed, program);
      EXPECT_THAT(seen.sent, ContainsRegex("\n\nN[0-9]+ M105[*]")) << "it was silent for long";
    }
}

// The oks of the empty lines behind it come all the same.
TEST(Macros, ASlowCommandWhoseAnswerGotLostIsNotTakenForGranted) {
  const std::vector<std::string> program = slow_program();
  Marlin firmware(Pace{1, false}, klipper());
  FaultyPort port(firmware);
  bool lost = false;
  port.on_send = [&](std::string& bytes) {
    if (bytes.find("PRINT_START") != std::string::npos && !std::exchange(lost, true)) bytes.clear();
  };
  PrintControl control;
  const auto failure = print(port, true, text(program), control);
  ASSERT_TRUE(failure);
  EXPECT_THAT(failure->what(), HasSubstr("executed line 2 (PRINT_START BED=50)"));
}

// 200 of them, each ahead of a move.
std::vector<std::string> moves_with(const std::string& command) {
  std::vector<std::string> program = moves("M83", 200);
  for (std::size_t i = program.size(); i-- > 5;)
    program.insert(program.begin() + static_cast<std::ptrdiff_t>(i), command + std::to_string(i));
  return program;
}

// A planner that waits for answers to questions runs dry: as long as all goes well, none is asked.
TEST(Macros, WhereNothingIsLostNobodyAsksForThePlace) {
  for (const char* command : {"SET_VELOCITY_LIMIT ACCEL=10", "LAYER_MACRO Z="}) {
    const std::vector<std::string> program = moves_with(command);
    std::size_t asked = 0;
    std::size_t questions = 0;
    const Outcome seen = outcome(program, [&](const std::string& line, std::string&) {
      asked += line == "M114";
      questions += line == "M105";
    });
    EXPECT_FALSE(seen.failure) << seen.failure->what();
    EXPECT_EQ(seen.executed, program);
    EXPECT_EQ(asked, 1u) << command << ": the end is proven";
    EXPECT_LT(questions, 10u) << command;
  }
}

// SET_VELOCITY_LIMIT is no macro of the user's: what was known of the head stays known.
TEST(Macros, BehindASettingThePlaceTellsAllTheSame) {
  const std::vector<std::string> program = moves_with("SET_VELOCITY_LIMIT ACCEL=10");
  for (const std::size_t lost : {40U, 41U}) {
    bool done = false;
    const Outcome lost_line = outcome(program, [&](const std::string& line, std::string& bytes) {
      if (line == program[lost] && !std::exchange(done, true)) bytes.clear();
    });
    EXPECT_FALSE(lost_line.failure) << lost_line.failure->what();
    EXPECT_EQ(lost_line.executed, program) << program[lost];
  }
  const Outcome lost_answer = outcome(program, {}, program[40]);
  EXPECT_FALSE(lost_answer.failure) << lost_answer.failure->what();
  EXPECT_EQ(lost_answer.executed, program) << program[40];
}

TEST(Macros, WhatAMacroDidNobodyKnows) {
  std::vector<std::string> program = moves("M83", 20);
  program.insert(program.begin() + 10, "M600");
  program.insert(program.begin() + 10, "M240");
  const Outcome seen = outcome(program, {}, "M240");
  ASSERT_TRUE(seen.failure);
  EXPECT_THAT(seen.failure->what(), HasSubstr("executed line 11 (M240): its answer got lost"));
}

}  // namespace
}  // namespace packmerger::test
