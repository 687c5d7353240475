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
  for (const std::size_t window : {0U, 96U}) {
    const Outcome seen = outcome(program, {}, "", window, Pace{1, false});
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

// Where it left the head, and how moves are read behind it, the printer tells when it is asked, so
// a lost answer or a lost line further on is made up for.
TEST(Macros, BehindAMacroThePlaceIsLearnedAgain) {
  for (const char* mode : {"M82", "M83"})
    for (const bool loses_line : {false, true}) {
      std::vector<std::string> program = moves(mode, 60);
      program.insert(program.begin() + 20, "LAYER_MACRO Z=1");
      bool done = false;
      const Harm harm = [&](const std::string& command, std::string& bytes) {
        if (loses_line && command == program[40] && !std::exchange(done, true)) bytes.clear();
      };
      const Outcome seen = outcome(program, harm, loses_line ? "" : program[40]);
      EXPECT_FALSE(seen.failure) << mode << loses_line << ": " << seen.failure->what();
      EXPECT_EQ(seen.executed, program) << mode << loses_line;
    }
}

// What is asked there may get lost as anything else: the macro was answered, and nobody doubts it.
TEST(Macros, WhatIsAskedBehindAMacroMayGetLost) {
  std::vector<std::string> program = moves("M83", 40);
  program.insert(program.begin() + 20, "LAYER_MACRO Z=1");
  bool behind_macro = false;
  int asked = 0;
  const Outcome seen = outcome(program, [&](const std::string& command, std::string& bytes) {
    behind_macro = behind_macro || command == program[20];
    if (behind_macro && command == "M114" && ++asked == 1) bytes.clear();
  });
  EXPECT_FALSE(seen.failure) << seen.failure->what();
  EXPECT_EQ(seen.executed, program);
  EXPECT_GE(asked, 3);
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
