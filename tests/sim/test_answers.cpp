// What proves that a printer is alive, and where it is: not what it says unasked, and no ok that is
// one too many.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "firmware_io/heat_watch.h"
#include "firmware_io/simulated/marlin.h"
#include "sim/programs.h"
#include "sim/scenario.h"

namespace packmerger::test {
namespace {

using simulated::Marlin;
using simulated::MarlinTraits;
using simulated::Pace;
using ::testing::HasSubstr;

TEST(Life, AQuarterOfAnHourOfHeatingInKlippersWay) {
  MarlinTraits traits;
  traits.heats_quietly = true;
  for (const bool autoreport : {true, false}) {
    traits.autoreport = autoreport;
    Marlin firmware(Pace{1, false}, traits);
    FaultyPort port(firmware);
    PrintControl control;
    StreamOptions options = scenario_options();
    options.timeout_s = 5;
    const auto failure =
        print(port, true, "M190 S921\nG28\nG1 X1\n", control, {}, options);  // 1 °C/s
    EXPECT_FALSE(failure) << failure->what();
    EXPECT_GT(port.now_s(), 900);
  }
}

// Reports come for ever, and nothing moves.
TEST(Life, AHeaterThatStandsStillIsNoSign) {
  HeatWatch watch;
  watch.begin("M190 S60");
  EXPECT_TRUE(watch.comes_nearer({{"bed", 30.0, 60.0}, {"tool", 20.0, 200.0}}));
  EXPECT_TRUE(watch.comes_nearer({{"bed", 30.1, 60.0}}));
  EXPECT_FALSE(watch.comes_nearer({{"bed", 30.1, 60.0}, {"tool", 90.0, 200.0}}));
  EXPECT_FALSE(watch.comes_nearer({{"bed", 30.0, 60.0}}));
  watch.begin("M109 R50");
  EXPECT_TRUE(watch.comes_nearer({{"tool 0", 90.0, 50.0}}));
  EXPECT_TRUE(watch.comes_nearer({{"tool 0", 80.0, 50.0}})) << "it cools";
  watch.begin("G28");
  EXPECT_FALSE(watch.comes_nearer({{"tool 0", 70.0, 50.0}}));
}

// However long it lasts and however seldom the printer says so.
TEST(Life, BusyAlwaysCounts) {
  for (const char* every : {"M113 S2", "M113 S10", "M113 S40"}) {
    Marlin firmware(Pace{1, false});
    FaultyPort port(firmware);
    PrintControl control;
    StreamOptions options = scenario_options();
    options.timeout_s = 10;
    const auto failure =
        print(port, true, std::string(every) + "\nG4 S3600\nG1 X1\n", control, {}, options);
    EXPECT_FALSE(failure) << every << failure->what();
    EXPECT_LT(count(port.executed(), "M105"), 20u) << "what it does not read must not pile up";
  }
}

TEST(Life, ADwellMayTakeWhatItStates) {
  MarlinTraits traits;
  traits.busy = false;
  for (const char* dwell : {"G4 S3600", "G4 P3600000"}) {
    Marlin firmware(Pace{1, false}, traits);
    FaultyPort port(firmware);
    PrintControl control;
    StreamOptions options = scenario_options();
    options.timeout_s = 10;
    const auto failure = print(port, true, std::string(dwell) + "\nG1 X1\n", control, {}, options);
    EXPECT_FALSE(failure) << dwell << failure->what();
  }
}

TEST(Life, ALostOkIsNoticedWhateverThePrinterTellsUnasked) {
  for (const char* trait : {"positions_unasked", "reports_unasked"}) {
    MarlinTraits traits;
    simulated::set_trait(traits, trait);
    Marlin firmware(Pace{1, true}, traits);
    FaultyPort port(firmware);
    lose_answers_behind(port, 20);
    PrintControl control;
    const auto failure = print(port, true, joined(gcode_program(200)), control);
    EXPECT_FALSE(failure) << failure->what();
    EXPECT_EQ(only(port.executed(), gcode_program(200)), gcode_program(200));
    EXPECT_LT(port.now_s(), 60) << trait;
  }
}

// The end is not proven by a position that nobody asked for.
TEST(Life, PositionsAreSilencedBeforeTheEndIsProven) {
  MarlinTraits traits;
  traits.positions_unasked = true;
  Marlin firmware(Pace{1, false}, traits);
  FaultyPort port(firmware);
  PrintControl control;
  const auto failure = print(port, true, joined(gcode_program(50)), control);
  EXPECT_FALSE(failure) << failure->what();
  EXPECT_EQ(count(port.executed(), "M154 S0"), 1u);
  EXPECT_EQ(only(port.executed(), gcode_program(50)), gcode_program(50));
}

// Which is no command of older firmware, and would be told as one that the printer passes over.
TEST(Life, ThePositionBehindHomingIsNotUnasked) {
  Marlin firmware(Pace{1, false});
  FaultyPort port(firmware);
  PrintControl control;
  EXPECT_FALSE(print(port, true, "G28\n" + joined(gcode_program(50)), control));
  EXPECT_THAT(port.executed(), ::testing::Contains("G28"));
  EXPECT_EQ(count(port.executed(), "M154 S0"), 0u);
}

// How far the host is ahead of the printer at most, over a line that doubles answers and hands
// them over in pieces. One line is on its way, so a lead of two is an ok too many.
std::size_t longest_lead(MarlinTraits traits, FaultRates rates) {
  Marlin firmware(Pace{1, false}, traits);
  FaultyPort port(firmware, rates, 3);
  const std::vector<std::string> program = gcode_program(600);
  std::size_t lead = 0;
  std::size_t seen = 0;
  port.on_step = [&](std::size_t) {
    if (port.sent.size() == seen) return;
    seen = port.sent.size();
    const std::size_t at = port.sent.rfind("\nN");
    // Under a wrong number it is only asked whether the printer counts.
    if (at == std::string::npos || port.sent.find("M105*", at) != std::string::npos) return;
    const auto given = static_cast<std::size_t>(std::atol(port.sent.c_str() + at + 2));
    const std::size_t executed = only(port.executed(), program).size();
    if (given > executed) lead = std::max(lead, given - executed);
  };
  PrintControl control;
  const auto failure = print(port, true, joined(program), control);
  EXPECT_FALSE(failure) << failure->what();
  EXPECT_EQ(only(port.executed(), program), program);
  return lead;
}

TEST(SurplusOks, OpenNothing) {
  MarlinTraits doubled;
  doubled.doubled_ok = true;
  EXPECT_LE(longest_lead(doubled, {}), 2u);
  EXPECT_LE(longest_lead(doubled, {.split = 1}), 8u);
  EXPECT_LE(longest_lead({}, {.duplicate = 0.1, .split = 1}), 8u);
  doubled.advanced_ok = true;
  EXPECT_LE(longest_lead(doubled, {.split = 1}), 3u) << "the printer names its lines";
}

}  // namespace
}  // namespace packmerger::test
