// Noise that makes another command of what the link asks beside the program: a printer that checks
// sums must refuse it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "firmware_io/simulated/marlin.h"
#include "sim/programs.h"
#include "sim/scenario.h"

namespace packmerger::test {
namespace {

using simulated::klipper;
using simulated::Marlin;
using simulated::marlin_1_1;
using simulated::MarlinTraits;
using simulated::Pace;
using ::testing::Contains;
using ::testing::Not;

// One flipped bit each: M107 turns the fan off, M125 parks the head.
constexpr std::size_t kDigit = 2;  // behind " M1"
void flip(std::string& bytes, std::size_t which) {
  const std::size_t at = bytes.find(" M105*");
  if (at == std::string::npos) return;
  char& digit = bytes[at + kDigit + 1 + which % 2];
  digit = static_cast<char>(digit ^ 2);
}

void expect_all_refused(const MarlinTraits& traits, const std::function<void(FaultyPort&)>& trouble,
                        PrintControl& control, const std::vector<std::string>& program,
                        Pace pace = {1, true}) {
  Marlin firmware(pace, traits);
  FaultyPort port(firmware);
  std::size_t asked = 0;
  port.on_send = [&](std::string& bytes) {
    if (bytes.find(" M105*") != std::string::npos && ++asked % 2 == 0) flip(bytes, asked / 2);
  };
  trouble(port);
  std::string text;
  for (const std::string& line : program) text += line + "\n";
  const auto failure = print(port, true, text, control);
  EXPECT_FALSE(failure) << failure->what();
  EXPECT_GE(asked, 3u);
  EXPECT_EQ(port.sent.find("\nM105\n"), std::string::npos) << "each has a number and a sum";
  for (const char* command : {"M107", "M125"}) EXPECT_THAT(port.executed(), Not(Contains(command)));
  EXPECT_EQ(only(port.executed(), program), program);
}

std::vector<MarlinTraits> firmwares_that_check_sums() {
  MarlinTraits checks_sums = klipper();
  checks_sums.checks_sums = true;
  return {MarlinTraits(), marlin_1_1(), checks_sums};
}

// Behind every hundredth line.
TEST(FlippedQuestion, IsRefusedInMidPrint) {
  for (const MarlinTraits& traits : firmwares_that_check_sums()) {
    PrintControl control;
    expect_all_refused(
        traits, [](FaultyPort&) {}, control, gcode_program(500));
  }
}

TEST(FlippedQuestion, IsRefusedBehindALostAnswer) {
  for (const MarlinTraits& traits : firmwares_that_check_sums()) {
    PrintControl control;
    expect_all_refused(
        traits, [](FaultyPort& port) { lose_answers_behind(port, 40); }, control,
        gcode_program(300));
  }
}

// Once every two seconds; what got lost of that in two hours is not to be made up for behind it.
TEST(FlippedQuestion, IsRefusedInAPause) {
  for (const MarlinTraits& traits : firmwares_that_check_sums()) {
    PrintControl control;
    const auto pauses = [&](FaultyPort& port) {
      port.on_step = [&, paused_s = 0.0, ended = false](std::size_t written) mutable {
        if (written >= 60 && paused_s == 0) {
          control.pause();
          paused_s = port.now_s();
        } else if (paused_s > 0 && port.now_s() > paused_s + 7200 && !std::exchange(ended, true)) {
          control.resume();
        }
      };
    };
    expect_all_refused(traits, pauses, control, gcode_program(200));
  }
}

// The safe text behind a failure has no numbers: the count may be what failed.
TEST(FlippedSafeText, TurnsTheHeatersOffAllTheSame) {
  MarlinTraits traits;
  traits.fatal_at = 60;
  Marlin firmware(Pace{1, true}, traits);
  FaultyPort port(firmware);
  std::size_t flipped = 0;
  port.on_send = [&](std::string& bytes) {
    const bool is_first =
        bytes == "M104 S0\n" ? flipped == 0 : bytes == "M140 S0\n" && flipped == 1;
    if (is_first) bytes[3] ^= 1, ++flipped;  // M105, M141
  };
  PrintControl control;
  EXPECT_TRUE(print(port, true, joined(gcode_program(100)), control));
  EXPECT_EQ(flipped, 2u);
  for (const char* command : {"M104 S0", "M140 S0"})
    EXPECT_THAT(port.executed(), Contains(command));
}

}  // namespace
}  // namespace packmerger::test
