#include "gcode/gcode_motion.h"

#include <gtest/gtest.h>

#include <numbers>

namespace packmerger {
namespace {

constexpr double kPi = std::numbers::pi;

struct Sums {
  double time_s = 0;
  double way_mm = 0;
  double filament_mm = 0;
  int doubt_line = 0;  // the first
};

Sums sums(std::string_view gcode, GcodeRules rules = GcodeRules::kMarlin) {
  GcodeMotion motion(rules);
  Sums sum;
  for_each_line(gcode, [&](std::string_view text, int number) {
    const GcodeStep step = motion.follow(GcodeLine(text, rules));
    sum.time_s += step.time_s;
    sum.way_mm += step.way_mm;
    sum.filament_mm += step.filament_mm;
    if (step.doubt && sum.doubt_line == 0) sum.doubt_line = number;
    return true;
  });
  return sum;
}

TEST(GcodeMotion, ArcsTakeTheTimeOfTheirLength) {
  // ten half circles of radius 50 at 5 mm/s
  std::string program = "G28\nG1 X50 Y100 F6000\n";
  const double there_s = sums(program).time_s;
  for (int i = 0; i < 5; ++i) program += "G2 X150 Y100 R50 F300\nG2X50Y100R50F300\n";
  EXPECT_NEAR(sums(program).time_s - there_s, 10 * kPi * 50 / 5, 0.01);
  const std::string start = "G28\nG1 X150 Y100 F6000\n";
  const double whole = sums(start + "G2 I-50 F600").way_mm - sums(start).way_mm;
  EXPECT_NEAR(whole, 2 * kPi * 50, 1e-6);
  EXPECT_NEAR(sums(start + "G2 X150 Y100 I-50 P2").way_mm - sums(start).way_mm, 3 * whole, 1e-6);
  // a helix
  const double helix = sums(start + "G3 X150 Y100 Z10 I-50").way_mm - sums(start).way_mm;
  EXPECT_NEAR(helix, std::hypot(2 * kPi * 50, 10), 1e-6);
  EXPECT_NEAR(sums("G28\nG20\nG1 X2 Y2\nG3 X3 Y3 J1").way_mm, 25.4 * (std::hypot(2, 2) + kPi / 2),
              1e-6);
}

TEST(GcodeMotion, InchesHoldForFeedAndFilament) {
  const Sums sum = sums("G28\nG20\nG1 X1 E0.1 F10");
  EXPECT_NEAR(sum.way_mm, 25.4, 1e-9);
  EXPECT_NEAR(sum.filament_mm, 2.54, 1e-9);
  EXPECT_NEAR(sum.time_s, 6, 1e-9);
}

TEST(GcodeMotion, DwellsAndSpeeds) {
  EXPECT_NEAR(sums("G4 P1500").time_s, 1.5, 1e-9);
  EXPECT_NEAR(sums("G4 S2 P1500").time_s, 2, 1e-9);
  EXPECT_NEAR(sums("G28\nM220 S50\nG1 X60 F60").time_s, 120, 1e-9);
  EXPECT_NEAR(sums("M221 S200\nG1 E3").filament_mm, 6, 1e-9);
  EXPECT_NEAR(sums("M200 D2\nG1 E3.14159265").filament_mm, 1, 1e-6);
  EXPECT_NEAR(sums("M200 D2\nM200 D0\nG1 E3").filament_mm, 3, 1e-9);
}

TEST(GcodeMotion, RelativeFilamentIsEachFirmwaresOwn) {
  const char* program = "M83\nG90\nG1 E2\nG1 E2";
  EXPECT_NEAR(sums(program).filament_mm, 2, 1e-9);  // G90 ends Marlin's M83
  EXPECT_NEAR(sums(program, GcodeRules::kGpx).filament_mm, 4, 1e-9);
  EXPECT_NEAR(sums("G91\nM82\nG1 E2\nG1 E2").filament_mm, 2, 1e-9);
  EXPECT_NEAR(sums("G1 A2 B1\nG1 A3 B1", GcodeRules::kGpx).filament_mm, 4, 1e-9);
  EXPECT_NEAR(sums("G1 A2", GcodeRules::kMarlin).filament_mm, 0, 1e-9);
}

TEST(GcodeMotion, WhatCannotBeFollowedIsADoubt) {
  EXPECT_EQ(sums("G28\nG2 X9 Y9").doubt_line, 2);
  EXPECT_EQ(sums("G2 X9 Y9 I5").doubt_line, 1);
  EXPECT_EQ(sums("T0\nG28\nT0\nT1").doubt_line, 4);
  EXPECT_EQ(sums("M135 T0\nM135 T1", GcodeRules::kGpx).doubt_line, 2);
  // lifting the head from wherever it is does no harm; going sideways may
  EXPECT_EQ(sums("G91\nG1 Z5").doubt_line, 0);
  EXPECT_EQ(sums("G91\nG1 X5").doubt_line, 2);
  EXPECT_EQ(sums("G28\nG29\nG91\nG1 Y5").doubt_line, 4);
  EXPECT_EQ(sums("G161 X Y").doubt_line, 1);  // a Replicator's
  EXPECT_EQ(sums("G161 X Y", GcodeRules::kGpx).doubt_line, 0);
}

}  // namespace
}  // namespace packmerger
