#include "printers/check/check_moves.h"

#include <gtest/gtest.h>

#include "fixtures/profiles.h"

namespace packmerger {
namespace {

const Box3 kCentred(Vec3(-112.5, -72.5, 0), Vec3(112.5, 72.5, 150));
const Box3 kFrontLeft(Vec3(0, 0, 0), Vec3(220, 220, 250));

// The line of the first fault, 0 where there is none.
int fault_line(std::string_view gcode, const Box3& volume = kFrontLeft,
               GcodeRules rules = GcodeRules::kMarlin) {
  const auto fault = check_moves(gcode, volume, rules);
  return fault ? fault->line : 0;
}

TEST(MachineVolume, FollowsTheOrigin) {
  Profile profile;
  profile.build_mm = {225, 145, 150};
  profile.origin = Origin::kCenter;
  EXPECT_EQ(machine_volume(profile).min(), Vec3(-112.5, -72.5, 0));
  EXPECT_EQ(machine_volume(profile).max(), Vec3(112.5, 72.5, 150));
  profile.origin = Origin::kFrontLeft;
  EXPECT_EQ(machine_volume(profile).min(), Vec3(0, 0, 0));
}

TEST(CheckMoves, InsideIsInside) {
  EXPECT_EQ(fault_line(""), 0);
  EXPECT_EQ(fault_line("G28\nG1 X0 Y0 Z0\nG1 X220 Y220 Z250 E9\nM104 S0\n; G1 X999\n"), 0);
  EXPECT_EQ(fault_line("G1 X220.009 Y0 Z1"), 0);
  EXPECT_EQ(fault_line("G28\r\nG1 X-112.5 Y72.5 Z0.2\r\nG1 X112.5 E1\r\n", kCentred), 0);
}

TEST(CheckMoves, TellsWhichMoveAndHowFarOut) {
  const auto fault = check_moves("G28\nG1 X10 Y10 Z1\nG1 X113.2 E5 ; skirt\nG1 X999\n", kCentred,
                                 GcodeRules::kMarlin);
  ASSERT_TRUE(fault);
  EXPECT_EQ(fault->line, 3);
  EXPECT_EQ(fault->command, "G1 X113.2 E5 ; skirt");
  EXPECT_EQ(fault->what, "goes to X 113.20, 0.70 mm beyond the build volume (-112.50 to 112.50)");
}

TEST(CheckMoves, EverySide) {
  for (const char* move : {"G1 X-0.02", "G1 X220.02", "G1 Y-0.02", "G0 Y220.02", "G1 Z-0.02",
                           "G0 Z250.02", "g1 x-1", "N7 G1X-1*33", "G1 X -1"})
    EXPECT_EQ(fault_line(std::string("G28\n") + move), 2) << move;
}

TEST(CheckMoves, RelativeMovesAddUp) {
  EXPECT_EQ(fault_line("G28\nG91\nG1 X100\nG1 X100\nG1 X20\nG1 X1\n"), 6);
  EXPECT_EQ(fault_line("G28\nG91\nG1 X100\nG90\nG1 X150\nG91\nG1 X-150.5\n"), 7);
  EXPECT_EQ(fault_line("G91\nG1 Z5\nG90\nG28\nG1 X5"), 0);  // lifting before homing passes
}

TEST(CheckMoves, G92ShiftsCoordinatesAndMovesNothing) {
  EXPECT_EQ(fault_line("G28\nG1 X200\nG92 X0\nG1 X20\nG1 X21\n"), 5);
  EXPECT_EQ(fault_line("G28\nG1 X200\nG92 X500\nG1 X510\n"), 0);
  EXPECT_EQ(fault_line("G28\nG1 X200\nG92 X500\nG1 X521\n"), 4);
  EXPECT_EQ(fault_line("G28\nG1 X200\nG92 X500\nG28\nG1 X300\n"), 5);  // homing ends the shift
  EXPECT_EQ(fault_line("G92 X100\nG91\nG1 X121\n"), 3);  // on an unknown axis it tells where it is
  EXPECT_EQ(fault_line("G28\nG92 E5\nG1 X220 E6"), 0);
}

TEST(CheckMoves, InchesAreMillimetresTimes254) {
  EXPECT_EQ(fault_line("G28\nG20\nG1 X8.6\nG1 X8.7\n"), 4);
  EXPECT_EQ(fault_line("G28\nG20\nG21\nG1 X8.7\n"), 0);
}

TEST(CheckMoves, ArcsByTheirTrueExtent) {
  // a half circle from (10, 10) to (10, 30): counter-clockwise bulges to the right, clockwise left
  const std::string start = "G28\nG1 X10 Y10 Z1\n";
  EXPECT_EQ(fault_line(start + "G3 X10 Y30 J10"), 0);
  EXPECT_EQ(fault_line(start + "G2 X10 Y30 J10"), 0);  // touches x = 0
  EXPECT_EQ(fault_line("G28\nG1 X9 Y10\nG2 X9 Y30 J10"), 3);
  EXPECT_EQ(fault_line("G28\nG1 X9 Y10\nG3 X9 Y30 J10"), 0);
  // a quarter that stays inside although its circle does not
  EXPECT_EQ(fault_line("G28\nG1 X5 Y15\nG3 X15 Y5 I10 J0"), 0);
  EXPECT_EQ(fault_line("G28\nG1 X5 Y15\nG2 X15 Y5 I10 J0"), 0);
  EXPECT_EQ(fault_line("G28\nG1 X5 Y15\nG2 X15 Y5 I3 J-3"), 0);
  // full circles: without end, and with the end at the start
  EXPECT_EQ(fault_line("G28\nG1 X30 Y15\nG2 I-20"), 3);
  EXPECT_EQ(fault_line("G28\nG1 X30 Y15\nG2 X30 Y15 I-5"), 0);
  EXPECT_EQ(fault_line("G28\nG1 X30 Y15\nG2 X30 Y15 I-20"), 3);
}

TEST(CheckMoves, ArcsByRadius) {
  EXPECT_EQ(fault_line("G28\nG1 X9 Y10\nG2 X9 Y30 R10"), 3);
  EXPECT_EQ(fault_line("G28\nG1 X9 Y10\nG3 X9 Y30 R10"), 0);
  // the shorter and the longer way round of a large circle
  EXPECT_EQ(fault_line("G28\nG1 X5 Y10\nG2 X5 Y30 R30"), 0);
  EXPECT_EQ(fault_line("G28\nG1 X5 Y10\nG2 X5 Y30 R-30"), 3);
  EXPECT_EQ(fault_line("G28\nG1 X9 Y10\nG2 X9 Y30 R5"), 3);  // too small to reach
}

TEST(CheckMoves, ArcsThatCannotBeJudgedAreFaults) {
  EXPECT_EQ(fault_line("G28\nG1 X9 Y10\nG2 X9 Y30"), 3);
  EXPECT_EQ(fault_line("G2 X9 Y30 I5"), 1);
  EXPECT_EQ(fault_line("G28\nG18\nG2 X9 Y30 I5"), 2);
  EXPECT_EQ(fault_line("G28\nG3 X9 Z251 I5"), 2);  // a helix too high
}

TEST(CheckMoves, ExtrudingWhereNobodyKnowsIsAFault) {
  EXPECT_EQ(fault_line("G1 X10 Y10 E1"), 1);
  EXPECT_EQ(fault_line("G1 X10 Y10\nG1 X20 E1"), 2);
  EXPECT_EQ(fault_line("G1 X10 Y10 Z1\nG1 X20 E1"), 2);  // never homed
  EXPECT_EQ(fault_line("G28 X Y\nG1 X10 Y10 Z1\nG1 X20 E1"), 3);
  EXPECT_EQ(fault_line("G92 X0 Y0 Z0\nG1 X10 Y10 Z1\nG1 X20 E1"), 0);
  EXPECT_EQ(fault_line("G1 E5 F300"), 0);  // filament alone
  EXPECT_EQ(fault_line("G28\nM84\nG1 X9 E1"), 3);
  EXPECT_EQ(fault_line("G28\nG29\nG1 X9 E1"), 0);  // somewhere above the bed
}

TEST(CheckMoves, AReplicatorKnowsWhereItIsOnceItIsTold) {
  const auto line = [](const std::string& text) {
    return fault_line(text, kCentred, GcodeRules::kGpx);
  };
  const std::string homed = "M83\nG162 X Y F2000\nG161 Z F900\n";
  EXPECT_EQ(line(homed + "G1 X5 Y5 Z1 F600\nG1 X9 E1"), 5);
  EXPECT_EQ(line(homed + "M132 X Y Z A B\nG1 X5 Y5 Z1 F600\nG1 X9 E1"), 0);
  EXPECT_EQ(line("M83\nG28\nG1 X9 Y9 Z1\nG1 X5 E1"), 4);
  EXPECT_EQ(line("M83\nG92 X0 Y0 Z0\nG1 X9 E1\nG162 X Y F2000\nG1 X5 E1"), 5);
  EXPECT_EQ(line("M83\nG92 X0 Y0 Z0\nG1 X9 E1\nG162 X Y F2000\nG1 X5 E-1"), 0);  // drawn back
}

TEST(CheckMoves, WhatItCannotFollowIsAFault) {
  for (const char* code : {"G5 X1 Y1 I1 J1", "G53", "G54", "G92.1", "G1 X", "G1 X5 G91", "G1 X1#2",
                           "M206 X10", "M428", "G19", "G68", "X500", "M600", "M808 L3", "g1 X5"})
    EXPECT_EQ(fault_line(std::string("G28\n") + code), 2) << code;
  for (const char* code : {"G4 P100", "M117 Go home now", "T0", "M73 P50", "G10", "G29"})
    EXPECT_EQ(fault_line(std::string("G28\n") + code), 0) << code;
}

TEST(CheckMoves, TheShippedStartAndEndTextsStayInside) {
  for (const char* id : {"replicator", "marlin"}) {
    const Profile profile = fixtures::shipped_profile(id);
    // the slicer's own places where the text has some
    std::string end = profile.slicer.end_gcode;
    while (end.find('{') != std::string::npos)
      end.erase(end.find('{'), end.find('}', end.find('{')) - end.find('{') + 1);
    const auto fault =
        check_moves(profile.slicer.start_gcode, machine_volume(profile), gcode_rules(profile));
    EXPECT_FALSE(fault) << id << ": " << fault->command << " " << fault->what;
  }
}

TEST(CheckMoves, WhatIsExtrudedStaysOffThePlatesWalls) {
  const Box3 volume(Vec3(0, 0, 0), Vec3(100, 100, 100));
  const Plate plate({{50, 0}, {100, 50}, {50, 100}, {0, 50}}, {{{48, 48}, {52, 48}, {50, 52}}});
  const auto line_of = [&](const std::string& moves) {
    const auto fault =
        check_moves("G28\nG90\nM82\nG1 Z1 F900\n" + moves, volume, GcodeRules::kMarlin, plate);
    return fault ? fault->line : 0;
  };
  EXPECT_EQ(line_of("G1 X50 Y10\nG1 X90 Y50 E1\nG1 X50 Y90 E2\n"), 0);
  EXPECT_EQ(line_of("G1 X5 Y5\nG1 X95 Y95\n"), 0);       // travel
  EXPECT_EQ(line_of("G1 X50 Y10\nG1 X90 Y10 E1\n"), 6);  // ends beyond the edge
  EXPECT_EQ(line_of("G1 X20 Y50\nG1 X80 Y50 E1\n"), 6);  // through the kept-out area
  EXPECT_EQ(line_of("G1 X20 Y50\nG1 X80 Y50\nG1 X81 E1\n"), 0);
  EXPECT_EQ(line_of("G1 X30 Y50\nG2 X70 Y50 I20 J0 E1\n"), 0);   // half round the kept-out area
  EXPECT_EQ(line_of("G1 X46 Y45\nG2 X54 Y45 I4 J0 E1\n"), 6);    // over it
  EXPECT_EQ(line_of("G1 X25 Y40\nG3 X40 Y25 I0 J-15 E1\n"), 6);  // and over the edge
}

TEST(CheckMoves, ThePlateIsInTheMachinesCoordinates) {
  Profile profile;
  profile.build_mm = {100, 80, 50};
  profile.origin = Origin::kCenter;
  profile.plate_mm = {{0, 0}, {100, 0}, {0, 80}};
  const Plate plate = machine_plate(profile);
  EXPECT_GT(plate.nearest_wall(Vec2(-40, -30)).clearance_mm, 0);
  EXPECT_LT(plate.nearest_wall(Vec2(40, 30)).clearance_mm, 0);
}

}  // namespace
}  // namespace packmerger
