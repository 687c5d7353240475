#include "printers/program/program.h"

#include <gtest/gtest.h>

#include <regex>

#include "base/error.h"
#include "base/files.h"
#include "base/process/process.h"
#include "fixtures/profiles.h"
#include "printers/program/x3g.h"
#include "printers/slice/slice.h"
#include "shapes.h"

namespace packmerger {
namespace {

using printed::box;
using printed::tray_of;

Tray small_cube() { return tray_of({box(Vec3(100, 60, 0), Vec3(110, 70, 5))}); }

Error error_of(const Profile& profile, const Tray& tray) {
  try {
    make_program(profile, tray, "x", Progress());
  } catch (const Error& error) {
    return error;
  }
  ADD_FAILURE() << "nothing was thrown";
  return Error(Fault::kInternal, "", "");
}

// What gpx's own reader makes of an x3g program.
std::string dump(const std::string& x3g) {
  const TemporaryFolder folder;
  write_file_whole(folder.path() / "p.x3g", x3g);
  ProcessSpec spec;
  spec.argv = {"s3gdump", "p.x3g"};
  spec.folder = folder.path();
  return run_process(spec, 60, Progress(), {}, std::size_t{64} << 20).out;
}

int count(const std::string& text, const std::string& what) {
  int found = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1))
    ++found;
  return found;
}

TEST(Program, HandoffMakesNone) {
  EXPECT_FALSE(make_program(fixtures::shipped_profile("objet30"), small_cube(), "x", Progress()));
}

TEST(Program, MarlinGetsItsGcode) {
  const Profile profile = fixtures::shipped_profile("marlin");
  const auto program = make_program(profile, small_cube(), "cube", Progress());
  ASSERT_TRUE(program);
  EXPECT_EQ(program->extension, "gcode");
  EXPECT_EQ(program->bytes, program->gcode);
  EXPECT_TRUE(program->warnings.empty());
  EXPECT_NE(program->gcode.find("G28 ; home all axes"), std::string::npos);
  EXPECT_NE(program->gcode.find("M84 ; motors off"), std::string::npos);
  EXPECT_NE(program->gcode.find("gcode_flavor = marlin"), std::string::npos);
}

TEST(Program, ReplicatorGetsX3gThatNamesTheBuild) {
  const auto program = make_program(fixtures::shipped_profile("replicator"), small_cube(),
                                    "bunny, 60 mm", Progress());
  ASSERT_TRUE(program);
  EXPECT_EQ(program->extension, "x3g");
  EXPECT_NE(program->gcode.find("gcode_flavor = sailfish"), std::string::npos);
  const std::string text = dump(program->bytes);
  EXPECT_EQ(count(text, "Start build notification"), 1);
  EXPECT_NE(text.find("name \"bunny_ 60 mm\""), std::string::npos) << text.substr(0, 400);
  EXPECT_EQ(count(text, "End build notification"), 1);
  EXPECT_EQ(count(text, "Recall home position"), 1);
  EXPECT_GE(count(text, "Wait until Tool 0 is ready"), 1);
  EXPECT_GT(count(text, "Move to"), 500);
}

TEST(Program, BuildNamesCannotBecomeOptionsOrPaths) {
  const Profile profile = fixtures::shipped_profile("replicator");
  for (const char* name : {"../../etc/passwd", "-C", "", "...", "a\nb",
                           "a name that is much longer than a Replicator can show"}) {
    const auto program = make_program(profile, small_cube(), name, Progress());
    ASSERT_TRUE(program) << name;
    std::smatch found;
    const std::string text = dump(program->bytes).substr(0, 2000);
    ASSERT_TRUE(std::regex_search(text, found, std::regex("name \"([A-Za-z0-9._ -]{1,31})\"")))
        << text;
  }
}

TEST(Program, StartTextsThatCouldHarmAReplicatorAreRefused) {
  const Profile whole = fixtures::shipped_profile("replicator");
  const auto without = [&](const std::string& codes) {
    Profile profile = whole;
    profile.slicer.start_gcode =
        std::regex_replace(whole.slicer.start_gcode, std::regex("(^|\n)(" + codes + ")"), "$1; $2");
    return error_of(profile, small_cube());
  };
  EXPECT_EQ(without("G161|G162").fault(), Fault::kBadProfile);
  EXPECT_NE(std::string(without("G161|G162").what()).find("homing"), std::string::npos);
  EXPECT_NE(std::string(without("M132").what()).find("M132"), std::string::npos);
  EXPECT_NE(std::string(without("M133").what()).find("heat"), std::string::npos);
  Profile empty = whole;
  empty.slicer.start_gcode.clear();
  EXPECT_EQ(error_of(empty, small_cube()).fault(), Fault::kBadProfile);
  // before anything is sliced: the tray here could not be
  EXPECT_EQ(error_of(empty, Tray()).fault(), Fault::kBadProfile);
}

TEST(Program, WhatGpxWouldPassOverIsRefusedWithItsLine) {
  for (const char* line : {"M0", "G10 P1 X5", "M104 S300 T0"}) {
    Profile profile = fixtures::shipped_profile("replicator");
    profile.slicer.start_gcode += std::string(line) + "\n";
    const Error error = error_of(profile, small_cube());
    EXPECT_EQ(error.fault(), Fault::kBadProfile);
    EXPECT_NE(std::string(error.what()).find(line), std::string::npos) << error.what();
  }
}

// What gpx only warns of: a tool the machine does not have.
TEST(Program, NothingThatGpxWarnsOfIsSent) {
  Profile profile = fixtures::shipped_profile("replicator");
  profile.slicer.gpx_machine = "r1";
  const std::string text =
      "G162 X Y F2500\nG161 Z F1100\nM132 X Y Z A B\nM104 S200 T1\nM133 T0\nM137\n";
  try {
    to_x3g(profile, text, "x", Fault::kBadInput, Progress());
    FAIL() << "nothing was thrown";
  } catch (const Error& error) {
    EXPECT_EQ(error.fault(), Fault::kBadInput);
    EXPECT_EQ(std::string(error.what()).find("Line 4 of the program, \"M104 S200 T1\": gpx"), 0U)
        << error.what();
  }
}

// As gpx's own reader tells it.
TEST(Program, ArcsInchesAndMakerBotsHeatComeThrough) {
  const Profile profile = fixtures::shipped_profile("replicator");
  const std::string start = "M136\nG162 X Y F2500\nG161 Z F1100\nM132 X Y Z A B\n";
  const auto dumped = [&](const std::string& text) {
    return dump(to_x3g(profile, start + text, "x", Fault::kBadInput, Progress()).bytes);
  };
  const std::string plate = dumped("M109 S110 T0\nM134 T0\nM135 T0\nM104 S230 T0\nM133 T0\nM137\n");
  EXPECT_EQ(count(plate, "Set build platform temperature to 110 C"), 1) << plate;
  EXPECT_EQ(count(plate, "Set target temperature to 230 C"), 1);
  EXPECT_EQ(count(plate, "Set target temperature to 110 C"), 0);
  const std::string nozzle = dumped("M109 S230 T0\nM137\n");
  EXPECT_EQ(count(nozzle, "Set target temperature to 230 C"), 1);
  const std::string arc = dumped("G1 X0 Y0 Z1 F600\nG92 E0\nG1 X20\nG2 X20 I-10 E5\nM137\n");
  EXPECT_GT(count(arc, "Move to"), 50);
  EXPECT_EQ(count(arc, "Define position"), 0);
  const std::string inches = dumped("G1 X0 Y0 Z1 F600\nG20\nG1 X1\nM137\n");
  EXPECT_EQ(count(inches, "distance 25.400000 mm"), 1) << inches;
}

TEST(Program, AMoveOutsideIsRefusedWithItsLine) {
  Profile profile = fixtures::shipped_profile("replicator");
  profile.slicer.start_gcode += "\nG1 X-113.2 Y0 F3000\n";
  const Error error = error_of(profile, small_cube());
  EXPECT_EQ(error.fault(), Fault::kBadProfile);
  EXPECT_NE(std::string(error.what()).find("\"G1 X-113.2 Y0 F3000\""), std::string::npos);
  EXPECT_NE(std::string(error.what()).find("0.70 mm beyond"), std::string::npos) << error.what();
}

TEST(Program, ASkirtOutsideIsLeftOutAndABrimRefused) {
  Profile profile = fixtures::shipped_profile("replicator");
  profile.slicer.options["skirts"] = "1";
  const Tray corner = tray_of({box(Vec3(0, 0, 0), Vec3(30, 30, 3))});
  const auto program = make_program(profile, corner, "corner", Progress());
  ASSERT_TRUE(program);
  ASSERT_EQ(program->warnings.size(), 1U);
  EXPECT_EQ(program->warnings[0].code, "skirt_left_out");
  profile.slicer.options["brim_width"] = "5";
  EXPECT_EQ(error_of(profile, corner).fault(), Fault::kBadProfile);
}

TEST(Program, SupportStaysInsideWithTheMarginThatIsAskedFor) {
  const Profile profile = fixtures::shipped_profile("replicator");
  const double margin = slicer_margin_mm(profile);
  const Mesh tee =
      printed::from_cells({margin, margin + 8, margin + 12, margin + 20},
                          {margin, margin + 8, margin + 12, margin + 20}, {0, 10, 12},
                          [](int x, int y, int z) { return z == 1 || (x == 1 && y == 1); });
  EXPECT_NO_THROW(make_program(profile, tray_of({tee}), "tee", Progress()));
  EXPECT_EQ(error_of(profile, tray_of({printed::moved(tee, Vec3(-margin, 0, 0))})).fault(),
            Fault::kBadProfile);
}

TEST(Program, WrongMachineForGpx) {
  Profile profile = fixtures::shipped_profile("replicator");
  profile.slicer.gpx_machine = "r9";
  const Error error = error_of(profile, small_cube());
  EXPECT_EQ(error.fault(), Fault::kBadProfile);
  EXPECT_NE(std::string(error.what()).find("r9"), std::string::npos);
}

}  // namespace
}  // namespace packmerger
