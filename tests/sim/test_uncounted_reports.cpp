// Printers that count no lines, and what their reports do not tell: RepRapFirmware's E, what was
// cut short, what is drowned in chatter.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sim/uncounted.h"

namespace packmerger::test {
namespace {

using simulated::klipper;
using simulated::Marlin;
using simulated::Pace;
using ::testing::HasSubstr;

// Old RepRapFirmware asks for what came garbled, and counts nothing all the same; newer drops it.
TEST(Uncounted, AnythingLostIsFoundThoughSumsAreChecked) {
  const std::vector<std::string> program = moves("M83", 60);
  for (const bool drops : {false, true})
    for (const std::size_t window : {0U, 96U}) {
      Marlin firmware(Pace{1, true}, rep_rap_firmware(drops));
      FaultyPort port(firmware);
      std::size_t step = 0;
      port.on_send = [&](std::string& bytes) {
        if (step == 5 || bytes.find(program[10 * (step + 1)] + "*") == std::string::npos) return;
        if (++step % 2 == 1)
          bytes[bytes.find('X') + 1] ^= 1;
        else
          bytes.clear();
      };
      PrintControl control;
      StreamOptions options = scenario_options();
      options.window_bytes = window;
      const auto failure = print(port, true, text(program), control, {}, options);
      EXPECT_FALSE(failure) << failure->what();
      EXPECT_EQ(step, 5u);
      EXPECT_EQ(only(port.executed(), program), program);
    }
}

// RepRapFirmware's E stays in relative mode: that it did not move proves nothing of a retraction.
TEST(Uncounted, ARetractionThatNoReportCountsIsNotMadeTwice) {
  for (const bool behind_moves : {false, true}) {
    std::vector<std::string> program = moves("M83", 60);
    program.insert(program.begin() + (behind_moves ? 30 : 5), "G1 E-0.8");
    Marlin firmware(Pace{1, true}, rep_rap_firmware(false));
    FaultyPort port(firmware);
    port.on_send = [&](std::string& bytes) {
      port.lose_answers = bytes.find("G1 E-0.8*") != std::string::npos;
    };
    PrintControl control;
    const auto failure = print(port, true, text(program), control);
    EXPECT_EQ(count(port.executed(), "G1 E-0.8"), 1u) << behind_moves;
    ASSERT_TRUE(failure) << behind_moves;
    EXPECT_THAT(failure->what(), HasSubstr("Nobody can tell"));
  }
}

// Of the first answer to M114 only "X:… Y:… Z:…" arrives: whether a retraction was lost or taken it
// does not tell, the next answer does.
TEST(Uncounted, AReportThatWasCutShortProvesNothing) {
  for (const bool loses_line : {false, true}) {
    std::vector<std::string> program = moves("M83", 60);
    program.insert(program.begin() + 30, "G1 E-.8");
    Marlin firmware(Pace{1, true}, klipper());
    FaultyPort port(firmware);
    bool lost = false;
    int cut = 0;
    port.on_send = [&](std::string& bytes) {
      const bool hit = command_of(bytes) == program[30] && !std::exchange(lost, true);
      port.lose_answers = hit && !loses_line;
      if (hit && loses_line) bytes.clear();
    };
    port.on_answer = [&](std::string& bytes) {
      const std::size_t at = bytes.find(" E:");
      if (at != std::string::npos && cut == 0 && ++cut == 1)
        bytes.erase(at, bytes.find('\n', at) - at);
    };
    PrintControl control;
    const auto failure = print(port, true, text(program), control);
    EXPECT_FALSE(failure) << failure->what();
    EXPECT_EQ(cut, 1);
    EXPECT_EQ(only(port.executed(), program), program) << loses_line;
  }
}

// A printer that never falls silent, while it is found out what became of a line: it is obeyed to a
// cancel at once whenever that comes.
TEST(Uncounted, ADoubtHoldsBackNoCancel) {
  const std::vector<std::string> program = moves("M83", 60);
  for (double wait_s = 0; wait_s < 12; wait_s += 0.5) {
    Marlin firmware(Pace{1, true}, klipper());
    FaultyPort port(firmware);
    PrintControl control;
    double doubted_at_s = simulated::kNever;
    double chattered_at_s = 0;
    double cancelled_at_s = simulated::kNever;
    double obeyed_at_s = simulated::kNever;
    port.on_send = [&](std::string& bytes) {
      const std::string command = command_of(bytes.substr(0, bytes.find('\n')));
      port.lose_answers = command == program[30];
      if (port.lose_answers) doubted_at_s = std::min(doubted_at_s, port.now_s());
      if (command == "M410") obeyed_at_s = port.now_s();
    };
    port.on_answer = [&](std::string& bytes) {
      if (port.now_s() < doubted_at_s || port.now_s() < chattered_at_s + 0.03) return;
      chattered_at_s = port.now_s();
      bytes += "echo:chatter\n";
    };
    port.on_step = [&](std::size_t) {
      if (port.now_s() < doubted_at_s + wait_s || cancelled_at_s < simulated::kNever) return;
      cancelled_at_s = port.now_s();
      control.cancel();
    };
    StreamOptions options = scenario_options();
    options.timeout_s = 5;
    options.safe_gcode.clear();
    const auto failure = print(port, true, text(program), control, {}, options);
    if (cancelled_at_s == simulated::kNever) break;
    ASSERT_TRUE(failure) << wait_s;
    EXPECT_EQ(failure->fault(), Fault::kInterrupted) << failure->what();
    EXPECT_LT(obeyed_at_s, cancelled_at_s + 0.5) << wait_s;
  }
}

}  // namespace
}  // namespace packmerger::test
