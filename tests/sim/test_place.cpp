// What is known of a line that a printer answered doubtfully: by its oks, and by its place.
#include <gtest/gtest.h>

#include <string>
#include <string_view>
#include <vector>

#include "firmware_io/gcode_place.h"
#include "firmware_io/gcode_tally.h"
#include "firmware_io/heat_watch.h"

namespace packmerger::test {
namespace {

GcodeTally asked_behind_a_line() {
  GcodeTally tally;
  tally.begin(false);
  for (const bool asks_temperatures : {true, false, true}) tally.count_sent(asks_temperatures);
  return tally;
}

bool is_proven_by(std::string_view oks) {
  GcodeTally tally = asked_behind_a_line();
  for (const char ok : oks) tally.count_ok(ok == 'T');
  return tally.proves_line(true);
}

// Of a line, M105, an empty line and M105; "-": ok, "T": ok with temperatures.
TEST(Tally, TellsTheLinesOwnOk) {
  EXPECT_TRUE(is_proven_by("-T-T"));
  EXPECT_TRUE(is_proven_by("-TT")) << "of a printer that answers no empty line";
  EXPECT_FALSE(is_proven_by("T-T")) << "the line got lost";
  EXPECT_FALSE(is_proven_by("-T")) << "the first or the last M105's";
  EXPECT_FALSE(is_proven_by(""));
  EXPECT_FALSE(GcodeTally(asked_behind_a_line()).proves_line(false));
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
  EXPECT_EQ(after({"G1 X1 Y1", "PRINT_START", "G21", "G90", "G1 Y2"}),
            (GcodePoint{std::nullopt, 2.0}));
  EXPECT_EQ(after({"G1 X1 Y1 Z1", "G92"}), nowhere) << "all are 0, or nothing was done";
  EXPECT_EQ(after({"G20", "G1 X1"}), nowhere);
}

// The place behind `line`, given behind a macro that left the head at `before`; learned from what
// is told behind it and behind the line.
GcodePoint after_macro(const GcodePoint& before, const std::string& line, const GcodePoint& told,
                       const std::string& next) {
  GcodePlace place;
  EXPECT_FALSE(place.wants_report("G1 X1"));
  const GcodeTrace macro = place.follow("LAYER_MACRO");
  EXPECT_TRUE(place.wants_report("LAYER_MACRO"));
  place.learn_modes("LAYER_MACRO", macro, before);
  const GcodeTrace trace = place.follow(line);
  EXPECT_TRUE(place.wants_report(line)) << line;
  place.learn_modes(line, trace, told);
  return place.follow(next).after;
}

TEST(Place, BehindAMacroIsLearnedFromTwoReports) {
  const GcodePoint before = {50.0, 60.0, 2.0, 10.0};
  const std::string next = "G1 X1 Y1 E1";
  EXPECT_EQ(after_macro(before, "G1 X70 Y80 E0.5", {70.0, 80.0, 2.0, 10.5}, next),
            (GcodePoint{1.0, 1.0, 2.0, 11.5}));
  EXPECT_EQ(after_macro(before, "G1 X7 Y8 E11", {57.0, 68.0, 2.0, 11.0}, next),
            (GcodePoint{58.0, 69.0, 2.0, 1.0}));
  EXPECT_EQ(after_macro(before, "G1 X1 E0.5", {25.4, 60.0, 2.0, 22.7}, next),
            (GcodePoint{std::nullopt, std::nullopt, 2.0}))
      << "inches";
  for (const auto& [line, told] : std::vector<std::pair<std::string, GcodePoint>>{
           {"G1 X0", {50.0, 60.0, 2.0, 10.0}},      // relative, in either unit
           {"G1 X70", {50.0, 60.0, 2.0, 10.0}},     // it got lost
           {"G1 X7 Y8", {64.0, 76.0, 2.0, 10.0}},   // it was doubled
           {"G1 X70", {70.008, 60.0, 2.0, 10.0}}})  // neither there nor elsewhere
    EXPECT_EQ(after_macro(before, line, told, next)[0], std::nullopt) << line;
  EXPECT_EQ(after_macro({0.0, 0.0, 0.0, 0.0}, "G1 X5 E0.1", {5.0, 0.0, 0.0, 0.1}, next),
            (GcodePoint{std::nullopt, std::nullopt, 0.0}))
      << "from the origin, absolute and relative lead to one place";
}

// However it is read, it leads elsewhere.
TEST(Place, TellsTheFateOfAMoveThatNobodyKnowsHowToRead) {
  const auto fate = [](const std::string& line, const GcodePoint& told) {
    GcodePlace place;
    const GcodeTrace macro = place.follow("LAYER_MACRO");
    place.learn_modes("LAYER_MACRO", macro, {50.0, 60.0, 2.0, 10.0});
    return fate_of(place.follow(line), told, true);
  };
  EXPECT_EQ(fate("G1 X7 E0.5", {57.0, 60.0, 2.0, 10.5}), GcodeFate::kTaken);
  EXPECT_EQ(fate("G1 X7 E0.5", {7.0, 60.0, 2.0, 10.5}), GcodeFate::kTaken);
  EXPECT_EQ(fate("G1 X7 E0.5", {50.0, 60.0, 2.0, 10.0}), GcodeFate::kMissed);
  EXPECT_EQ(fate("G1 X7 E0.5", {64.0, 60.0, 2.0, 11.0}), GcodeFate::kUnknown) << "doubled";
  EXPECT_EQ(fate("G1 X70 E0.5", {70.0, 60.0, 2.0, 11.0}), GcodeFate::kUnknown) << "doubled";
  EXPECT_EQ(fate("G1 X50", {50.0, 60.0, 2.0, 10.0}), GcodeFate::kTaken) << "it has an answer";
  EXPECT_EQ(fate("G1 X7 E0.5", {57.0, std::nullopt, 2.0}), GcodeFate::kUnknown);
}

TEST(Place, NothingIsAskedOnceItIsKnown) {
  GcodePlace place;
  place.follow("PRINT_START");
  EXPECT_FALSE(place.wants_report("M104 S200")) << "it leads nowhere";
  for (const char* line : {"G21", "G90", "M83"}) place.follow(line);
  EXPECT_FALSE(place.wants_report("G1 X1 E1"));
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
  const GcodeTrace heats = place.follow("M104 S200");
  EXPECT_EQ(fate_of(heats, {10.0, 0.0, 0.0, 0.0}, true), GcodeFate::kTaken);
  EXPECT_EQ(fate_of(heats, {10.0, 0.0, 0.0, 0.0}, false), GcodeFate::kRepeatable);
  const GcodeTrace macro = place.follow("START_PRINT");
  EXPECT_EQ(fate_of(macro, {10.0, 0.0, 0.0, 0.0}, false), GcodeFate::kUnknown);
}

}  // namespace
}  // namespace packmerger::test
