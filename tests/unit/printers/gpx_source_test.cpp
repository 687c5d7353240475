#include "printers/program/gpx_source.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "gcode/gcode_motion.h"

#include "fixtures/fault_of.h"

namespace packmerger {
namespace {

const std::string kHomed = "G162 X Y F2500\nG161 Z F1100\nM132 X Y Z A B\n";
const std::string kStart = kHomed + "G1 X0 Y0 Z5 F600\n";

std::string source(const std::string& gcode) { return gpx_source(gcode, Fault::kBadInput).gcode; }

// The last line, without its number.
std::string last(const std::string& gcode) {
  std::string text = source(gcode);
  text.pop_back();
  text.erase(0, text.rfind('\n') + 1);
  return text.substr(text.find(' ') + 1);
}

std::string refusal(const std::string& gcode) {
  SCOPED_TRACE(gcode);
  return fixtures::refusal_of([&] { source(gcode); });
}

TEST(GpxSource, IsAbsoluteInMillimetresByTool) {
  EXPECT_EQ(last(kStart + "G1 X5 E2 F1200"), "G1 X5.00000 A2.00000 F1200.000");
  EXPECT_EQ(last(kStart + "G1 E2\nG92 E0\nG1X6E2"), "G1 X6.00000 A4.00000");
  EXPECT_EQ(last(kStart + "G20\nG1 X1 E0.1 F10"), "G1 X25.40000 A2.54000 F254.000");
  EXPECT_EQ(last(kStart + "G91\nG1 X3\nG1 X4"), "G1 X7.00000");
  EXPECT_EQ(last(kStart + "G92 X100\nG1 X101"), "G1 X1.00000");
  EXPECT_EQ(last(kStart + "M83\nG90\nG1 E1\nG1 E1"), "G1 A2.00000");
  EXPECT_EQ(last(kStart + "G1 A5\nM132 A B\nG1 A1"), "G1 A1.00000");
  EXPECT_EQ(last(kStart + "M135 T1\nG1 E1"), "G1 B1.00000");
  EXPECT_EQ(last("N5 M104 S200 T0*33"), "M104 S200.00000 T0.00000");
  EXPECT_EQ(last("G4 S2"), "G4 P2000");
  EXPECT_EQ(last("M70 P5 (hello * there)"), "M70 P5.00000 (hello * there)");
  // each line carries the number of the one it comes from
  EXPECT_NE(source("; nothing\n\nM18 X Y\n").find("N3 M18 X Y\n"), std::string::npos);
}

TEST(GpxSource, DrawsArcsAsLinesNearThem) {
  const std::string text = source(kStart + "G1 X20\nG2 X20 Y0 Z6 I-10 E5 F600\n");
  GcodeMotion motion(GcodeRules::kGpx);
  double way_mm = 0;
  double filament_mm = 0;
  int lines = 0;
  for_each_line(text, [&](std::string_view line, int) {
    const GcodeStep step = motion.follow(GcodeLine(line, GcodeRules::kGpx));
    if (!line.starts_with("N6 ")) return true;
    ++lines;
    way_mm += step.way_mm;
    filament_mm += step.filament_mm;
    const Vec2 middle((*step.from[0] + *step.to[0]) / 2, (*step.from[1] + *step.to[1]) / 2);
    EXPECT_NEAR((middle - Vec2(10, 0)).norm(), 10, 0.0101);
    return true;
  });
  EXPECT_GT(lines, 50);
  EXPECT_NEAR(way_mm, std::hypot(20 * std::numbers::pi, 1), 0.1);
  EXPECT_NEAR(filament_mm, 5, 1e-4);
  EXPECT_NE(text.find(" X20.00000 Y0.00000 Z6.00000 A5.00000\n"), std::string::npos);
}

// gpx sets every axis whenever one is named.
TEST(GpxSource, TellsWhereTheMachineIsForAllAxesOrNone) {
  EXPECT_EQ(last(kHomed + "G92 E0\nM18"), "M18");
  EXPECT_EQ(source(kHomed + "G92 E0\n").find("G92"), std::string::npos);
  EXPECT_EQ(last("G161 Z\nG92 Z0"), "G92 X0.00000 Y0.00000 Z0.00000 A0.00000 B0.00000");
  EXPECT_NE(refusal(kHomed + "G92 Z0").find("only the machine knows"), std::string::npos);
  EXPECT_EQ(last(kHomed + "G92 X1 Y2 Z3"), "G92 X1.00000 Y2.00000 Z3.00000 A0.00000 B0.00000");
}

TEST(GpxSource, RefusesByLineWhatWouldBeLostOrChanged) {
  for (const char* line :
       {"G2 X5 Y5",    "G3 X5 Y5 R1", "G5 X1",         "G18",      "G29",       "G10 P1 X5",
        "G11",         "G54",         "G70",           "G92.1",    "M0",        "M1",
        "M2\nM104 S0", "M322 Z5",     "M109 R200",     "M190 R60", "M104 S300", "M104 S-1",
        "M140 S131",   "M131 X",      "M141 S50",      "M206 X5",  "M600",      "M500",
        "M999",        "X5 Y5",       "G1 X5 #",       "G161",     "D3",        "M106.5",
        ";@pause 5",   "; x",         "(@machine r2)", "hello"}) {
    if (std::string_view(line) == "; x") {
      EXPECT_NO_THROW(source(kStart + line));
      continue;
    }
    const int number = std::string_view(line).starts_with("M2\n") ? 6 : 5;
    EXPECT_EQ(refusal(kStart + line).find("Line " + std::to_string(number) + " "), 0U) << line;
  }
  EXPECT_NE(refusal("G1 X5").find("nobody knows"), std::string::npos);
  EXPECT_NE(refusal("G162 X Y\nG91\nG1 Z5").find("nobody knows"), std::string::npos);
  EXPECT_NE(refusal(kStart + "M18\nG1 X5").find("nobody knows"), std::string::npos);
}

TEST(GpxSource, TellsWhatItLeavesOut) {
  const GpxSource made = gpx_source(
      "M117 Go home X5\nM204 P500\nM117 G1 X9\nM84 S300\nM73 R5\nM400\n", Fault::kBadInput);
  EXPECT_EQ(made.gcode, "N1 G90\nN1 M82\n");
  ASSERT_EQ(made.warnings.size(), 1U);
  EXPECT_EQ(made.warnings[0].code, "left_out");
  EXPECT_NE(made.warnings[0].text.find("M117 (2), M204 (1), M400 (1), M84 (1)"), std::string::npos)
      << made.warnings[0].text;
}

// A Replicator's fan is on or off, so gpx turns it fully on.
TEST(GpxSource, TellsOfAFanThatIsToTurnInPart) {
  EXPECT_TRUE(gpx_source("M106\nM106 S255\nM106 S0\nM107\nM126 T0\nM106 S0.4\n", Fault::kBadInput)
                  .warnings.empty());
  const GpxSource made =
      gpx_source("M106 S255\nM106 S64\nM126 S9\nM106 P0 S254\n", Fault::kBadInput);
  EXPECT_NE(made.gcode.find("N2 M106 S64.00000\n"), std::string::npos);
  ASSERT_EQ(made.warnings.size(), 1U);
  EXPECT_EQ(made.warnings[0].code, "fan_full");
  EXPECT_NE(
      made.warnings[0].text.find("Line 2 of the program turns the fan on in part, as do 2 others"),
      std::string::npos)
      << made.warnings[0].text;
}

// gpx knows extruders that turn by speed and time, as ReplicatorG's programs prime the nozzle.
TEST(GpxSource, PassesOnWhatTurnsTheExtruder) {
  EXPECT_EQ(last(kStart + "M108 R5"), "M108 R5.00000");
  EXPECT_EQ(last(kStart + "M101"), "M101");
  EXPECT_EQ(last(kStart + "M108 T1"), "M135 T1");
}

TEST(GpxFlavour, IsToldByWhatOnlyOneHas) {
  const auto makerbot = [](const std::string& gcode) {
    return gpx_source(gcode, Fault::kBadInput).makerbot_flavour;
  };
  EXPECT_TRUE(makerbot("M136\nM109 S110 T0\nM134 T0\nM135 T0\nM104 S230 T0\nM133 T0\n"));
  EXPECT_FALSE(makerbot("M109 S110\n"));
  EXPECT_FALSE(makerbot("M136\nM82\nM109 S220\nM133 T0\n"));  // no plate is as hot
  EXPECT_TRUE(makerbot(";@flavor makerbot\nM82\nM109 S100\n"));
  EXPECT_FALSE(makerbot(";@flavor reprap\nM136\nM109 S100\n"));
  const std::string text = refusal("M136\nM83\nM109 S110\nM133 T0\n");
  EXPECT_EQ(text.find("Line 3 "), 0U) << text;
  EXPECT_NE(text.find("MakerBot"), std::string::npos);
  EXPECT_NE(refusal("M136\nM190 S60\nM109 S100\n").find("Line 3 "), std::string::npos);
  EXPECT_NE(refusal("M136\nM109 S230\nM134\nM109 S110\n").find("Line 4 "), std::string::npos);
}

}  // namespace
}  // namespace packmerger
