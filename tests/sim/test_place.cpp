// What is known of a line that a printer answered doubtfully: by its oks, and by its place.
#include <gtest/gtest.h>

#include <string>
#include <string_view>
#include <vector>

#include "firmware_io/gcode/gcode_place.h"
#include "firmware_io/gcode/gcode_tally.h"
#include "firmware_io/gcode/heat_watch.h"

namespace packmerger::test {
namespace {

GcodeTally asked_behind_a_line() {
  GcodeTally tally;
  tally.begin(false);
  tally.count_sent(true);
  tally.count_empty_line();
  tally.count_sent(true);
  return tally;
}

GcodeTally answered_with(std::string_view oks) {
  GcodeTally tally = asked_behind_a_line();
  for (const char ok : oks) tally.count_ok(ok == 'T');
  return tally;
}

bool is_proven_by(std::string_view oks) { return answered_with(oks).proves_line(true, true); }

// Of a line, M105, an empty line and M105; "-": ok, "T": ok with temperatures.
TEST(Tally, TellsTheLinesOwnOk) {
  EXPECT_TRUE(is_proven_by("-T-T"));
  EXPECT_TRUE(is_proven_by("-TT")) << "of a printer that answers no empty line";
  EXPECT_FALSE(is_proven_by("T-T")) << "the line got lost";
  EXPECT_FALSE(is_proven_by("-T")) << "the first or the last M105's";
  EXPECT_FALSE(is_proven_by(""));
  EXPECT_FALSE(asked_behind_a_line().proves_line(false, true));
}

TEST(Tally, TellsWhetherAnEmptyLineIsAnswered) {
  EXPECT_EQ(answered_with("-T-T").tells_of_empty_line(), true);
  EXPECT_EQ(answered_with("-TT").tells_of_empty_line(), false);
  EXPECT_EQ(answered_with("-T").tells_of_empty_line(), std::nullopt) << "one has no answer";
  GcodeTally slow;  // an empty line and M105 behind it
  slow.begin(false);
  slow.count_empty_line();
  slow.count_sent(true);
  for (const bool has_temperature : {false, true}) slow.count_ok(has_temperature);
  EXPECT_EQ(slow.tells_of_empty_line(), std::nullopt);
  EXPECT_FALSE(slow.proves_line(true, true)) << "the one ok may be the empty line's";
  EXPECT_TRUE(slow.proves_line(true, false));
}

// PRINT_START heats as its user wrote it, and says nothing but the temperatures.
TEST(Heat, OfAMacroIsWhateverComesNearerToItsTarget) {
  HeatWatch watch;
  watch.begin("PRINT_START BED=60 R=3");
  EXPECT_TRUE(watch.comes_nearer({{"tool", 22, 0}, {"bed", 30, 60}}));
  EXPECT_TRUE(watch.comes_nearer({{"tool", 22, 0}, {"bed", 31, 60}}));
  EXPECT_FALSE(watch.comes_nearer({{"tool", 22, 0}, {"bed", 31, 60}}));
  EXPECT_TRUE(watch.comes_nearer({{"tool", 22, 200}, {"bed", 60, 60}}));
  EXPECT_TRUE(watch.comes_nearer({{"tool", 40, 200}, {"bed", 60, 60}}));
  watch.begin("G1 X3");
  EXPECT_FALSE(watch.comes_nearer({{"tool", 50, 200}, {"bed", 60, 60}}));
}

GcodePoint after(const std::vector<std::string>& lines) {
  GcodePlace place;
  GcodeTrace trace;
  for (const std::string& line : lines) trace = place.follow(line);
  return trace.after;
}

TEST(Place, IsWhatM114Tells) {
  const GcodePoint nowhere;
  EXPECT_EQ(after({"G28"}), nowhere);
  EXPECT_EQ(after({"G92 E0", "G1 X1 Y2 Z3 E4"}), (GcodePoint{1.0, 2.0, 3.0, 4.0}));
  EXPECT_EQ(after({"G1 X1 Y2 Z3", "G91", "M83", "G1 X1 E1"}), (GcodePoint{2.0, 2.0, 3.0}));
  EXPECT_EQ(after({"G92 X0 E0", "M83", "G1 X1 E1", "G1 E-0.25"}),
            (GcodePoint{1.0, std::nullopt, std::nullopt, 0.75}));
  EXPECT_EQ(after({"G92 X0 E0", "G91", "G1 X1 E1"}), (GcodePoint{1.0}))
      << "whether G91 is for E too depends on the firmware";
  EXPECT_EQ(after({"G1 X1 Y1 E1", "M104 S200", "M117 X5", "M84", "T0"}), nowhere);
  for (const char* macro : {"PRINT_START BED=60", "TIMELAPSE", "MOVE_AWAY", "G1 X\"1\""})
    EXPECT_EQ(after({"G1 X1 Y1", macro, "G1 Y2"}), nowhere) << "maybe relative, maybe inches";
  for (const char* setting :
       {"SET_VELOCITY_LIMIT ACCEL=9", "set_fan_speed FAN=a SPEED=1", "RESPOND"})
    EXPECT_EQ(after({"G1 X1 Y1", setting, "G1 Y2"}), (GcodePoint{1.0, 2.0})) << setting;
  EXPECT_EQ(after({"G1 X1 Y1", "SET_GCODE_OFFSET Z=1", "G1 Y2"}), nowhere) << "another origin";
  EXPECT_EQ(after({"G1 X1 Y1", "PRINT_START", "G21", "G90", "G1 Y2"}),
            (GcodePoint{std::nullopt, 2.0}));
  EXPECT_EQ(after({"G1 X1 Y1 Z1", "G92"}), nowhere) << "all are 0, or nothing was done";
  EXPECT_EQ(after({"G20", "G1 X1"}), nowhere);
}

TEST(Place, IsReadFromAReport) {
  EXPECT_EQ(read_gcode_point("X:1.500 Y:-2.00 Z:0.30 E:12.5 Count X:120 Y:0 Z:5"),
            (GcodePoint{1.5, -2.0, 0.3, 12.5}));
  EXPECT_EQ(read_gcode_point("ok X:1 Y:2?5 E:nan"), (GcodePoint{1.0}));
}

TEST(Place, TellsALinesFate) {
  GcodePlace place;
  place.follow("G92 X0 Y0 Z0 E0");
  const GcodeTrace moved = place.follow("G1 X10");
  EXPECT_EQ(fate_of(moved, {10.0, 0.0, 0.0, 0.0}, false), GcodeFate::kTaken);
  EXPECT_EQ(fate_of(moved, {0.0, 0.0, 0.0, 0.0}, true), GcodeFate::kMissed);
  EXPECT_EQ(fate_of(moved, {10.0, 0.0, 0.0, 5.0}, true), GcodeFate::kUnknown);
  EXPECT_EQ(fate_of(moved, {std::nullopt, 0.0, 0.0, 0.0}, true), GcodeFate::kUnknown);
  const GcodeTrace extrudes = place.follow("G1 E2");
  EXPECT_EQ(fate_of(extrudes, {10.0, 0.0, 0.0}, true), GcodeFate::kUnknown) << "it was cut short";
  place.follow("G92 E0");
  place.follow("M83");
  const GcodePoint retracted = {10.0, 0.0, 0.0, -1.0};
  const GcodePoint uncounted = {10.0, 0.0, 0.0, 0.0};
  const GcodeTrace retracts = place.follow("G1 E-1");
  EXPECT_EQ(fate_of(retracts, retracted, false), GcodeFate::kTaken);
  EXPECT_EQ(fate_of(retracts, uncounted, true), GcodeFate::kUnknown)
      << "it got lost, or E is not counted in relative mode";
  const GcodeTrace both = place.follow("G1 X20 E1");
  EXPECT_EQ(fate_of(both, {20.0, 0.0, 0.0, 0.0}, false), GcodeFate::kTaken) << "counted or not";
  EXPECT_EQ(fate_of(both, uncounted, false), GcodeFate::kMissed);
  EXPECT_EQ(fate_of(both, {20.0, 0.0, 0.0, 1.0}, false), GcodeFate::kUnknown) << "doubled";
  place.follow("G1 X10 E1");
  GcodePlace counting = place;
  place.learn(uncounted);
  counting.learn({10.0, 0.0, 0.0, 1.0});
  EXPECT_EQ(place.follow("G1 E1").after, uncounted);
  EXPECT_EQ(fate_of(counting.follow("G1 E-1"), uncounted, true), GcodeFate::kTaken);
  const GcodePoint before = {10.0, 0.0, 0.0, 0.0};
  EXPECT_EQ(fate_of(counting.follow("G1 E-1"), before, true), GcodeFate::kMissed);
  place.follow("M82");
  place.follow("G92 E0");
  place.follow("G1 X10");
  const GcodeTrace heats = place.follow("M104 S200");
  EXPECT_EQ(fate_of(heats, {10.0, 0.0, 0.0, 0.0}, true), GcodeFate::kTaken);
  EXPECT_EQ(fate_of(heats, {10.0, 0.0, 0.0, 0.0}, false), GcodeFate::kRepeatable);
  const GcodeTrace macro = place.follow("START_PRINT");
  EXPECT_EQ(fate_of(macro, {10.0, 0.0, 0.0, 0.0}, false), GcodeFate::kUnknown);
  const GcodeTrace relative = place.follow("G1 X3 E1");
  EXPECT_EQ(fate_of(relative, {13.0, 0.0, 0.0, 1.0}, true), GcodeFate::kUnknown)
      << "it may have been made twice, or not at all";
  EXPECT_EQ(fate_of(place.follow("G1 F1800"), {13.0, 0.0, 0.0, 1.0}, true), GcodeFate::kTaken);
}

}  // namespace
}  // namespace packmerger::test
