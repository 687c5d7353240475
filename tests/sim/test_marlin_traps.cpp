// The traps of Marlin as docs/PROTOCOLS lists them: that the simulated one sets them as the true
// one did, and that a print gets through each alone.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "base/error.h"
#include "firmware_io/simulated/marlin.h"
#include "sim/programs.h"
#include "sim/scenario.h"
#include "sim/wire.h"

namespace packmerger::test {
namespace {

using simulated::Marlin;
using simulated::marlin_1_1;
using simulated::MarlinTraits;
using simulated::Pace;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

constexpr Pace kRealTime{1, false};

std::size_t count(const std::string& text, const std::string& what) {
  std::size_t found = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1))
    ++found;
  return found;
}

MarlinTraits with(std::string_view change, MarlinTraits traits = {}) {
  EXPECT_TRUE(set_trait(traits, change)) << change;
  return traits;
}

std::string line(std::size_t number, const std::string& command) {
  const std::string text = "N" + std::to_string(number) + " " + command;
  int sum = 0;
  for (char c : text) sum ^= c;
  return text + "*" + std::to_string(sum) + "\n";
}

TEST(MarlinTraps, DoubledLinesAreSilentOn2AndAskedForOn1) {
  for (const bool silent : {true, false}) {
    Marlin marlin(kRealTime, silent ? MarlinTraits() : marlin_1_1());
    Wire wire(marlin);
    EXPECT_EQ(wire.says(line(1, "M82") + line(2, "M83")), "ok\nok\n");
    const std::string asks =
        "Error:Line Number is not Last Line Number+1, Last Line: 2\nResend: 3\nok\n";
    EXPECT_EQ(wire.says(line(1, "M82")), silent ? "" : asks);
    EXPECT_EQ(wire.says(line(2, "M83")), silent ? "" : asks);
    EXPECT_EQ(wire.says(line(9, "M83")), asks);
  }
}

TEST(MarlinTraps, OverflowIsSilentUntilALineEnds) {
  for (const bool overflows : {true, false}) {
    Marlin marlin(kRealTime, with(overflows ? "rx_overflow=on" : "rx_overflow=off", marlin_1_1()));
    Wire wire(marlin);
    std::string lines = line(1, "G4 P500");
    for (std::size_t n = 2; n <= 21; ++n)
      lines += line(n, "G1 X" + std::to_string(n) + ".5 Y0 F600");
    const std::string said = wire.says(lines, 60);
    EXPECT_THAT(said, Not(HasSubstr("Resend")));
    EXPECT_EQ(count(said, "ok\n") < 21, overflows) << said;
    EXPECT_EQ(wire.says("\n").empty(), !overflows);
    EXPECT_EQ(marlin.take_executed().size(), count(said, "ok\n"));
  }
}

TEST(MarlinTraps, ABareLineEndGetsAHalfLineAskedFor) {
  Marlin marlin(kRealTime, marlin_1_1());
  Wire wire(marlin);
  EXPECT_EQ(wire.says("N1 G1 X1"), "");
  EXPECT_EQ(wire.says("\n"), "Error:No Checksum with line number, Last Line: 0\nResend: 1\nok\n");
  EXPECT_EQ(wire.says("\n\n"), "") << "an empty line gets no ok";
}

TEST(MarlinTraps, EmergencyCommandsWorkOnlyRaw) {
  Marlin marlin(kRealTime, marlin_1_1());
  Wire wire(marlin);
  EXPECT_EQ(wire.says("M190 S60\n"), "");
  EXPECT_THAT(wire.says("N1 M112*32\n", 4.6), Not(HasSubstr("halted")));
  EXPECT_THAT(wire.says("M112\n"), StartsWith("Error:Printer halted. kill() called!\n"));
  EXPECT_EQ(wire.says("M105\nM115\n", 60), "") << "a halted printer answers nothing";
}

TEST(MarlinTraps, AnEmergencyParserLooksAtNoNumberAndNoSum) {
  for (const bool parser : {true, false}) {
    Marlin marlin(kRealTime, with(parser ? "emergency_parser=on" : "emergency_parser=off"));
    Wire wire(marlin);
    EXPECT_EQ(count(wire.says("N9 M112*0\n"), "Printer halted"), parser ? 1U : 0U);
  }
}

TEST(MarlinTraps, AFullQueueHoldsEmergencyCommandsBack) {
  for (const bool parser : {true, false}) {
    Marlin marlin(kRealTime, with(parser ? "emergency_parser=on" : "emergency_parser=off"));
    Wire wire(marlin);
    wire.says("M190 S60\nM82\nM82\nM82\nM82\n");
    EXPECT_EQ(count(wire.says("M112\n", 3), "Printer halted"), parser ? 1U : 0U);
  }
}

TEST(MarlinTraps, M108EndsAWaitAndThreeOksCome) {
  Marlin marlin(kRealTime, marlin_1_1());
  Wire wire(marlin);
  EXPECT_EQ(wire.says("M190 S60\nM105\n"), "");
  EXPECT_EQ(count(wire.says("M108\n"), "ok"), 3U);
}

TEST(MarlinTraps, ResetForgetsTheLineCountAndSaysStart) {
  Marlin marlin(kRealTime);
  Wire wire(marlin);
  wire.says(line(1, "M82") + line(2, "M83"));
  marlin.reset();
  EXPECT_THAT(wire.says(""), StartsWith("start\n"));
  EXPECT_THAT(wire.says(line(3, "M82")), HasSubstr("Resend: 1\n"));
}

TEST(MarlinTraps, SaysBusyWhileACommandBlocks) {
  for (const bool busy : {true, false}) {
    Marlin marlin(kRealTime, with(busy ? "busy=on" : "busy=off"));
    Wire wire(marlin);
    const std::string said = wire.says("G28\nM82\n", 4.9);
    EXPECT_EQ(said, busy ? "echo:busy: processing\necho:busy: processing\n" : "");
    EXPECT_EQ(wire.says("", 0.2), "X:0.00 Y:0.00 Z:0.00 E:0.00 Count X:0 Y:0 Z:0\nok\nok\n")
        << "homing ends with the position";
  }
}

TEST(MarlinTraps, AsksItsUser) {
  Marlin marlin(kRealTime);
  Wire wire(marlin);
  EXPECT_EQ(wire.says("M0 Change tool\n"),
            "echo:Change tool\r\n//action:prompt_end\n//action:prompt_begin Change tool\n"
            "//action:prompt_button Continue\n//action:prompt_show\n");
  EXPECT_EQ(wire.says("", 2), "echo:busy: paused for user\n");
  EXPECT_EQ(wire.says("M876 S0\n"), "ok\nok\n");
  EXPECT_THAT(wire.says("M112\n"), HasSubstr("//action:poweroff\n"));
}

TEST(MarlinTraps, AFilamentChangeAsksTwice) {
  Marlin marlin(kRealTime);
  Wire wire(marlin);
  EXPECT_THAT(wire.says("M600\n"), HasSubstr("prompt_begin Nozzle Parked\n"));
  const std::string purges = wire.says("M108\n");
  EXPECT_THAT(purges, HasSubstr("//action:prompt_button Purge More\n//action:prompt_button Cont"));
  EXPECT_EQ(wire.says("M108\n"), "");
  EXPECT_THAT(wire.says("M876 S0\n"), HasSubstr("Purge More")) << "more was purged";
  EXPECT_EQ(count(wire.says("M876 S1\n"), "ok\n"), 5U);
  Marlin plain(kRealTime, marlin_1_1());
  EXPECT_EQ(Wire(plain).says("M600 U5\n"), "echo:Unknown command: \"M600 U5\"\nok\n");
}

TEST(MarlinTraps, KlipperWritesABlankBehindSlashes) {
  Marlin marlin(kRealTime, with("comment_blank", with("filament_change=off")));
  Wire wire(marlin);
  EXPECT_EQ(wire.says("M600 U5\n"), "// Unknown command:\"M600\"\nok\n");
  marlin.tell_host("paused");
  EXPECT_EQ(wire.says(""), "// action:paused\n");
}

TEST(MarlinTraps, AStoppedPrinterSaysSoAtEveryMove) {
  Marlin marlin(kRealTime, with("stops_at=2"));
  Wire wire(marlin);
  EXPECT_EQ(wire.says("M104 S200\n"), "ok\n");
  EXPECT_THAT(wire.says("M82\n"), HasSubstr("Error:!! STOP called"));
  EXPECT_THAT(wire.says("G1 X1\n"), StartsWith("Printer stopped due to errors."));
  EXPECT_THAT(wire.says("M105\n"), HasSubstr("/0.00"));
  EXPECT_EQ(wire.says("M999\nG1 X1\n"), "ok\nok\n");
}

TEST(MarlinTraps, AFatalPrinterGoesOnAnswering) {
  Marlin marlin(kRealTime, with("fatal_at=2"));
  Wire wire(marlin);
  EXPECT_EQ(wire.says("M82\n"), "ok\n");
  EXPECT_THAT(wire.says("G1 X1\n"), ::testing::MatchesRegex("fatal: .*\nok\n"));
  EXPECT_EQ(wire.says("G1 X2\n"), "ok\n");
}

TEST(MarlinTraps, LinesAreCountedFromOne) {
  MarlinTraits traits;
  for (const char* wrong : {"stops_at", "stops_at=", "stops_at=on", "stops_at=0", "stops_at=-1",
                            "stops_at=4x", "starts_at=4"})
    EXPECT_FALSE(set_trait(traits, wrong)) << wrong;
  EXPECT_TRUE(set_trait(traits, "stops_at=4"));
  EXPECT_TRUE(set_trait(traits, "stops_at=off"));
  EXPECT_EQ(traits.stops_at, 0U);
}

TEST(MarlinTraps, ARefusedMoveIsAnsweredWithOkAllTheSame) {
  Marlin marlin(kRealTime, with("refuses_at=1"));
  Wire wire(marlin);
  EXPECT_THAT(wire.says("G1 X1\n"), ::testing::EndsWith("\nok\n"));
  EXPECT_EQ(wire.says("G1 X1\n"), "ok\n");
}

TEST(MarlinTraps, SomeLinesEndInCarriageReturns) {
  Marlin marlin(kRealTime, with("crlf=off", with("prompts=off")));
  Wire wire(marlin);
  EXPECT_EQ(wire.says("M0 Change tool\n"), "echo:Change tool\n");
}

TEST(MarlinTraps, SaysWhatItCan) {
  Marlin rich(kRealTime);
  Marlin plain(kRealTime, marlin_1_1());
  Wire rich_wire(rich);
  Wire plain_wire(plain);
  const std::string told = rich_wire.says("M115\n");
  for (const char* line : {"FIRMWARE_NAME:Marlin 2.1.2", "Cap:EMERGENCY_PARSER:1\n",
                           "Cap:PROMPT_SUPPORT:1\n", "Cap:AUTOREPORT_TEMP:1\n"})
    EXPECT_THAT(told, HasSubstr(line));
  const std::string plainly = plain_wire.says("M115\n");
  for (const char* line :
       {"FIRMWARE_NAME:Marlin 1.1.9", "Cap:EMERGENCY_PARSER:0\n", "Cap:PROMPT_SUPPORT:0\n"})
    EXPECT_THAT(plainly, HasSubstr(line));
}

TEST(MarlinTraps, M110AnywhereSetsTheLineCount) {
  for (const bool anywhere : {true, false}) {
    Marlin marlin(kRealTime, with(anywhere ? "m110_anywhere=on" : "m110_anywhere=off"));
    Wire wire(marlin);
    const std::string said = wire.says(line(700, "M117 M1100"));
    EXPECT_EQ(said.find("Last Line: 0") == std::string::npos, anywhere) << said;
  }
}

TEST(MarlinTraps, WaysToAskForALine) {
  const std::string bad = "N1 G28*99\n";
  const auto asks = [&](const MarlinTraits& traits) {
    Marlin marlin(kRealTime, traits);
    return Wire(marlin).says(bad);
  };
  EXPECT_EQ(asks({}), "Error:checksum mismatch, Last Line: 0\nResend: 1\nok\n");
  EXPECT_EQ(asks(with("resend_error=off")), "Resend: 1\nok\n");
  EXPECT_EQ(asks(with("resend_ok=off")), "Error:checksum mismatch, Last Line: 0\nResend: 1\n");
  EXPECT_EQ(asks(with("resend_short")), "Error:checksum mismatch, Last Line: 0\nrs N1\nok\n");
}

TEST(MarlinTraps, AdvancedOkButNotBehindResend) {
  Marlin marlin(kRealTime, with("advanced_ok"));
  Wire wire(marlin);
  EXPECT_EQ(wire.says(line(1, "M82")), "ok N1 P15 B4\n");
  EXPECT_EQ(wire.says("M82\n"), "ok P15 B4\n");
  EXPECT_THAT(wire.says("N2 M83*99\n"), ::testing::EndsWith("Resend: 2\nok\n"));
}

TEST(MarlinTraps, SaysWaitWhileItIsIdle) {
  Marlin marlin(kRealTime, with("idle_wait"));
  Wire wire(marlin);
  wire.says("M82\n");
  EXPECT_EQ(wire.says("", 3.5), "wait\nwait\nwait\n");
}

TEST(MarlinTraps, ReportsTemperaturesUnasked) {
  Marlin marlin(kRealTime, with("reports_unasked"));
  Wire wire(marlin);
  EXPECT_GE(count(wire.says("", 3.5), " T:21.00 /0.00 B:21.00"), 3U);
  EXPECT_EQ(wire.says("M155 S0\n"), "ok\n");
  EXPECT_EQ(wire.says("", 3.5), "");
}

TEST(MarlinTraps, TellsItsPositionUnasked) {
  Marlin marlin(kRealTime, with("positions_unasked"));
  Wire wire(marlin);
  EXPECT_GE(count(wire.says("", 3.5), "X:0.00 Y:0.00"), 3U);
  EXPECT_EQ(wire.says("M154 S0\n"), "ok\n");
  EXPECT_EQ(wire.says("", 3.5), "");
}

TEST(MarlinTraps, ChattersOfNothing) {
  Marlin marlin(kRealTime, with("chatters"));
  Wire wire(marlin);
  const std::string said = wire.says("", 3.5);
  EXPECT_GE(count(said, "echo:"), 3U);
  EXPECT_GE(count(said, "// "), 3U);
}

TEST(MarlinTraps, HeatsWithoutAnySignButTemperatures) {
  Marlin marlin(kRealTime, with("heats_quietly"));
  Wire wire(marlin);
  const std::string said = wire.says("M190 S60\n", 10);
  EXPECT_GE(count(said, " B:"), 8U);
  EXPECT_THAT(said, Not(HasSubstr("W:")));
  EXPECT_THAT(said, Not(HasSubstr("busy")));
}

TEST(MarlinTraps, EveryFifthOkComesTwice) {
  Marlin marlin(kRealTime, with("doubled_ok"));
  EXPECT_EQ(count(Wire(marlin).says("M82\nM82\nM82\nM82\nM82\n"), "ok\n"), 6U);
}

TEST(MarlinTraps, LooksAtNoNumberAndAnswersAnEmptyLine) {
  Marlin marlin(kRealTime, with("counts_lines=off"));
  Wire wire(marlin);
  EXPECT_EQ(wire.says(line(7, "M82") + line(7, "M82") + "N1 M83*99\n\n"), "ok\nok\nok\nok\n");
}

TEST(MarlinTraps, ChecksSumsButCountsNothing) {
  MarlinTraits traits = with("counts_lines=off");
  traits.checks_sums = true;
  Marlin marlin(kRealTime, traits);
  Wire wire(marlin);
  EXPECT_EQ(wire.says(line(7, "M82") + line(3, "M82") + "\nN9 M83*1\n"), "ok\nok\nResend: 9\nok\n");
  traits.drops_garbled = true;
  Marlin newer(kRealTime, traits);
  EXPECT_EQ(Wire(newer).says("N9 M83*1\n" + line(7, "M82")), "ok\n");
}

TEST(MarlinTraps, AMacroTakesItsTime) {
  Marlin marlin(kRealTime, with("macros"));
  Wire wire(marlin);
  EXPECT_EQ(wire.says("PRINT_START BED=60\n", 7),
            "echo:busy: processing\necho:busy: processing\necho:busy: processing\n");
  EXPECT_THAT(wire.says("", 2), HasSubstr("ok\n"));
  EXPECT_THAT(wire.says("W1\n"), HasSubstr("Unknown command"));
}

TEST(MarlinTraps, WhatIsBeyond95BytesIsDroppedAndTheLineAskedForAgain) {
  Marlin marlin(kRealTime);
  Wire wire(marlin);
  for (int i = 0; i < 3; ++i)
    EXPECT_THAT(wire.says(line(1, "M117 " + std::string(90, 'a'))), HasSubstr("Resend: 1\n"));
}

// Each trap alone, on either version, over a clean line and over one that damages some bytes.
class EachMarlinTrap : public ::testing::TestWithParam<std::string> {};

TEST_P(EachMarlinTrap, IsPrintedThrough) {
  const std::vector<std::string> program = gcode_program(120);
  for (const MarlinTraits& version : {MarlinTraits(), marlin_1_1()})
    for (const char* value : {"=on", "=off"})
      for (const double rate : {0.0, 0.01}) {
        // What is garbled on its way to a printer that checks no sums, nobody can put right.
        if (rate > 0 && GetParam() + value == "counts_lines=off") continue;
        Marlin marlin(kRealTime, with(GetParam() + value, version));
        FaultyPort port(marlin, {.drop_byte = rate, .flip = rate, .split = 0.5}, 7);
        PrintControl control;
        const auto failure = print(port, true, joined(program), control);
        EXPECT_FALSE(failure) << version.version << value << rate << ": " << failure->what();
        EXPECT_EQ(only(port.executed(), program), program) << version.version << value << rate;
        EXPECT_EQ(port.faults() > 0, rate > 0);
      }
}

INSTANTIATE_TEST_SUITE_P(All, EachMarlinTrap, ::testing::ValuesIn(simulated::marlin_trait_names()),
                         [](const auto& trap) { return trap.param; });

}  // namespace
}  // namespace packmerger::test
