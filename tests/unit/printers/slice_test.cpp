#include "printers/slice/slice.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <numbers>

#include "base/error.h"
#include "base/files.h"
#include "fixtures/profiles.h"
#include "gcode/gcode_line.h"
#include "printers/check/check_moves.h"
#include "printers/estimate/estimate.h"
#include "printers/program/program.h"
#include "printers/slice/slicer_settings.h"
#include "shapes.h"

namespace packmerger {
namespace {

using printed::box;
using printed::tray_of;

Profile replicator() { return fixtures::shipped_profile("replicator"); }

SlicedTray figures(const Profile& profile, std::vector<Mesh> parts) {
  return slice(profile, tray_of(std::move(parts)), SliceFlavour::kFigures, Progress());
}

Tray small_cube() { return tray_of({box(Vec3(100, 60, 0), Vec3(110, 70, 5))}); }

// An error's fault and text; fails the test where nothing is thrown.
template <typename Call>
std::pair<Fault, std::string> error_of(const Call& call) {
  try {
    call();
  } catch (const Error& error) {
    EXPECT_FALSE(error.hint().empty());
    return {error.fault(), error.what()};
  }
  ADD_FAILURE() << "nothing was thrown";
  return {Fault::kInternal, ""};
}

TEST(SlicerSettings, FollowFromTheProfile) {
  Profile profile = replicator();
  profile.slicer.options["skirts"] = "1";
  const SlicerConfig config = slicer_config(profile, SliceFlavour::kProgram, 50);
  EXPECT_EQ(config.values.at("bed_shape"), "-112.5x-72.5,112.5x-72.5,112.5x72.5,-112.5x72.5");
  EXPECT_EQ(config.values.at("max_print_height"), "150");
  EXPECT_EQ(config.values.at("layer_height"), "0.2");
  EXPECT_EQ(config.values.at("support_material_threshold"), "45");
  EXPECT_EQ(config.values.at("gcode_flavor"), "sailfish");
  EXPECT_EQ(config.values.at("skirts"), "1");
  EXPECT_NE(config.values.at("start_gcode").find("\\nG162"), std::string::npos);
  EXPECT_EQ(config.values.at("start_gcode").find('\n'), std::string::npos);
  EXPECT_EQ(slicer_config(profile, SliceFlavour::kFigures, 50).values.at("gcode_flavor"), "marlin");
  Profile triangular = profile;
  triangular.plate_mm = {{0, 0}, {225, 0}, {100, 145}};
  EXPECT_EQ(slicer_config(triangular, SliceFlavour::kProgram, 50).values.at("bed_shape"),
            "-112.5x-72.5,112.5x-72.5,-12.5x72.5");
}

TEST(SlicerSettings, LeavesOutWhatHasNoRoom) {
  Profile profile = replicator();
  profile.slicer.options["skirts"] = "1";
  EXPECT_NEAR(slicer_margin_mm(profile), 3.02, 1e-12);
  EXPECT_FALSE(slicer_config(profile, SliceFlavour::kProgram, 13).skirt_left_out);
  const SlicerConfig tight = slicer_config(profile, SliceFlavour::kProgram, 3.42);
  EXPECT_TRUE(tight.skirt_left_out);
  EXPECT_EQ(tight.values.at("skirts"), "0");
  EXPECT_EQ(tight.values.at("raft_first_layer_expansion"), "0.4");
  EXPECT_EQ(slicer_margin_mm(fixtures::shipped_profile("objet30")), 0);
}

TEST(SlicerSettings, RefusesWhatItSetsItself) {
  Profile profile = replicator();
  profile.slicer.options["bed_shape"] = "0x0,1x1";
  EXPECT_EQ(error_of([&] { slicer_config(profile, SliceFlavour::kProgram, 9); }).first,
            Fault::kBadProfile);
  profile = replicator();
  profile.slicer.options["evil\nstart_gcode"] = "G1 X999";
  EXPECT_EQ(error_of([&] { slicer_config(profile, SliceFlavour::kProgram, 9); }).first,
            Fault::kBadProfile);
}

TEST(SlicerSettings, EveryOptionMustHaveBeenUnderstood) {
  Profile profile;
  profile.slicer.options = {{"fill_density", "10"}, {"perimeters", "2"}};
  check_settings_used(profile, {{"fill_density", "10%"}, {"perimeters", "2.0"}});
  EXPECT_THROW(check_settings_used(profile, {{"fill_density", "10%"}}), Error);
  EXPECT_THROW(check_settings_used(profile, {{"fill_density", "15%"}, {"perimeters", "2"}}), Error);
}

TEST(Slice, CubeMaterialAndTime) {
  const SlicedTray cube = figures(replicator(), {box(Vec3(100, 60, 0), Vec3(120, 80, 20))});
  EXPECT_NEAR(cube.time_s, 1266, 127);
  EXPECT_NEAR(cube.model_g, 3.34, 0.2);
  EXPECT_EQ(cube.support_mm3, 0);
  // the slicer's own sum leaves nothing out
  const std::string label = "; filament used [cm3] = ";
  const double cm3 = std::atof(cube.gcode.c_str() + cube.gcode.find(label) + label.size());
  EXPECT_NEAR(cube.model_mm3 / 1000, cm3, 0.02);
}

TEST(Slice, TableOfThePaper) {
  const Estimate e = estimate_by_slicer(
      replicator(), {tray_of({printed::table(72, 56, 5, 7, Vec3(70, 35, 0))})}, {1, 0}, Progress());
  EXPECT_NEAR(e.time_s, 9540, 954);
  EXPECT_NEAR(e.support_g, 17.2, 1.72);
  EXPECT_EQ(e.source, EstimateSource::kSlicer);
  EXPECT_GT(e.cost, 0);
}

TEST(Slice, TheToolPathEstimateIsNear) {
  const Profile profile = replicator();
  std::vector<Mesh> models{box(Vec3(40, 40, 0), Vec3(60, 60, 20)),
                           box(Vec3(40, 40, 0), Vec3(80, 80, 40)),
                           printed::table(72, 56, 5, 7, Vec3(40, 40, 0)),
                           printed::cover(Vec3(60, 60, 40), 3, Vec3(40, 40, 0)),
                           printed::moved(printed::resting_sphere(30, 5), Vec3(20, 20, 0))};
  for (const Mesh& model : models) {
    const Tray tray = tray_of({model});
    const Estimate fast = estimate(profile, {tray}, {}, Progress());
    const Estimate sliced = estimate_by_slicer(profile, {tray}, {}, Progress());
    EXPECT_NEAR(fast.time_s, sliced.time_s, 0.25 * sliced.time_s);
    EXPECT_NEAR(fast.model_g, sliced.model_g, 0.2 * sliced.model_g);
  }
}

TEST(Slice, PartsKeepTheirHeightAboveEachOther) {
  // two plates, one above the other on a post of its own: nothing may be dropped to the plate
  const Mesh low = box(Vec3(100, 60, 0), Vec3(120, 80, 2));
  const Mesh high = printed::from_cells({95, 99, 120}, {60, 80}, {0, 8, 10},
                                        [](int x, int, int z) { return x == 0 || z == 1; });
  const SlicedTray sliced = figures(replicator(), {low, high});
  EXPECT_NE(sliced.gcode.find(";Z:10\n"), std::string::npos);
  double highest = 0;
  for_each_line(sliced.gcode, [&](std::string_view text, int) {
    if (text.starts_with(";Z:")) highest = std::max(highest, std::atof(text.data() + 3));
    return true;
  });
  EXPECT_NEAR(highest, 10, 1e-6);
}

TEST(Slice, StandsWhereTheTrayPutsIt) {
  Profile profile = replicator();
  profile.slicer.options["skirts"] = "1";
  // corner region of the tray: x from 20 to 30 is −92.5 to −82.5 for a central origin
  const SlicedTray sliced = figures(profile, {box(Vec3(20, 30, 0), Vec3(30, 40, 1))});
  Box3 volume(Vec3(-92.5 - 9, -42.5 - 9, 0), Vec3(-82.5 + 9, -32.5 + 9, 1));
  std::string moves = "G92 X-92 Y-42 Z0\n" + sliced.gcode;
  const auto fault = check_moves(moves, volume, GcodeRules::kMarlin);
  EXPECT_FALSE(fault) << fault->command << " " << fault->what;
}

TEST(Slice, NeedsNoEnvironment) {
  std::vector<std::pair<std::string, std::string>> saved;
  for (const char* name : {"HOME", "DISPLAY", "USER", "XDG_CONFIG_HOME", "LANG", "PATH"}) {
    if (const char* value = std::getenv(name)) saved.emplace_back(name, value);
    ::unsetenv(name);
  }
  SlicedTray sliced;
  EXPECT_NO_THROW(sliced = slice(replicator(), small_cube(), SliceFlavour::kFigures, Progress()));
  for (const auto& [name, value] : saved) ::setenv(name.c_str(), value.c_str(), 1);
  EXPECT_GT(sliced.time_s, 60);
}

TEST(Slice, RefusesWhatTheSlicerWouldPassOver) {
  const auto fault = [](std::vector<Mesh> parts) {
    return error_of([&] { figures(replicator(), std::move(parts)); }).first;
  };
  EXPECT_EQ(fault({box(Vec3(200, 60, 0), Vec3(226, 70, 5))}), Fault::kBadInput);  // too far right
  EXPECT_EQ(fault({box(Vec3(-1, 60, 0), Vec3(20, 70, 5))}), Fault::kBadInput);
  EXPECT_EQ(fault({box(Vec3(20, 60, 0), Vec3(30, 70, 151))}), Fault::kBadInput);   // too high
  EXPECT_EQ(fault({box(Vec3(20, 60, 0.5), Vec3(30, 70, 9))}), Fault::kBadInput);   // in the air
  EXPECT_EQ(fault({box(Vec3(20, 60, -0.5), Vec3(30, 70, 9))}), Fault::kBadInput);  // in the plate
  EXPECT_EQ(fault({}), Fault::kBadInput);
}

TEST(Slice, TellsWhatTheSlicerSays) {
  const auto with_option = [](const char* name, const char* value) {
    Profile profile = replicator();
    profile.slicer.options[name] = value;
    return error_of([&] { slice(profile, small_cube(), SliceFlavour::kFigures, Progress()); });
  };
  EXPECT_EQ(with_option("no_such_option", "1").first, Fault::kBadProfile);
  EXPECT_EQ(with_option("fill_pattern", "no_such_pattern").first, Fault::kBadProfile);
  EXPECT_EQ(with_option("perimeters", "many").first, Fault::kBadProfile);
  const auto [fault, text] = with_option("infill_speed", "-5");
  EXPECT_EQ(fault, Fault::kBadProfile);
  EXPECT_NE(text.find("infill_speed"), std::string::npos) << text;
  Profile thick = replicator();
  thick.layer_mm = 0.9;
  EXPECT_EQ(error_of([&] { slice(thick, small_cube(), SliceFlavour::kFigures, Progress()); }).first,
            Fault::kBadProfile);
  Profile garbled = replicator();
  garbled.slicer.start_gcode += "\nG1 {nonsense}\n";
  EXPECT_EQ(
      error_of([&] { slice(garbled, small_cube(), SliceFlavour::kProgram, Progress()); }).first,
      Fault::kBadProfile);
}

TEST(Slice, SettingsRunNoPrograms) {
  const TemporaryFolder folder;
  const std::string mark = (folder.path() / "it-ran").string();
  for (const std::string& value : {"/usr/bin/touch " + mark, "\"\";/usr/bin/touch " + mark}) {
    Profile profile = replicator();
    profile.slicer.options["post_process"] = value;
    const auto [fault, text] =
        error_of([&] { slice(profile, small_cube(), SliceFlavour::kFigures, Progress()); });
    EXPECT_EQ(fault, Fault::kBadProfile);
    EXPECT_NE(text.find("post_process"), std::string::npos) << text;
    EXPECT_FALSE(fs::exists(mark));
  }
  // what nearly every exported settings file has
  for (const char* nothing : {"", " ", "\"\""}) {
    Profile profile = replicator();
    profile.slicer.options = {{"perimeters", "2"}, {"post_process", nothing}};
    EXPECT_EQ(slicer_config(profile, SliceFlavour::kFigures, 50).values.count("post_process"), 0U);
    EXPECT_NO_THROW(check_settings_used(profile, {{"perimeters", "2"}}));
  }
}

TEST(Slice, MissingSlicerIsSaidWithItsInstallLine) {
  const char* path = std::getenv("PATH");
  const std::string saved = path != nullptr ? path : "";
  ::setenv("PATH", "/nowhere", 1);
  try {
    figures(replicator(), {box(Vec3(20, 60, 0), Vec3(30, 70, 5))});
    ADD_FAILURE() << "nothing was thrown";
  } catch (const Error& error) {
    EXPECT_EQ(error.fault(), Fault::kUnavailable);
    EXPECT_NE(error.hint().find("apt-get install"), std::string::npos);
  }
  ::setenv("PATH", saved.c_str(), 1);
}

// What ends the slicer says nothing of the model; what the slicer says does.
TEST(Slice, ASlicerThatDiesRefusesNothing) {
  const TemporaryFolder folder;
  const char* path = std::getenv("PATH");
  const std::string saved = path != nullptr ? path : "";
  ::setenv("PATH", (folder.path().string() + ":" + saved).c_str(), 1);
  const auto ending = [&](const std::string& script) {
    const fs::path slicer = folder.path() / "prusa-slicer";
    write_file_whole(slicer, "#!/bin/sh\n" + script + "\n");
    fs::permissions(slicer, fs::perms::owner_all);
    return error_of([&] { figures(replicator(), {box(Vec3(20, 60, 0), Vec3(30, 70, 5))}); });
  };
  EXPECT_EQ(ending("echo Slicing; kill -9 $$").first, Fault::kIo);
  EXPECT_EQ(ending("echo std::bad_alloc >&2; exit 1").first, Fault::kIo);
  EXPECT_EQ(ending("exit 127").first, Fault::kIo);
  EXPECT_EQ(ending("echo 'There are no extrusions in the first layer.' >&2; exit 1").first,
            Fault::kBadInput);
  const auto [fault, text] = ending("yes trouble | head -n 100000 >&2; exit 1");
  EXPECT_EQ(fault, Fault::kBadInput);
  EXPECT_LT(text.size(), 3000U);
  ::setenv("PATH", saved.c_str(), 1);
}

TEST(Slice, CanBeInterrupted) {
  const std::atomic<bool> cancelled{true};
  EXPECT_THROW(slice(replicator(), small_cube(), SliceFlavour::kFigures, Progress({}, &cancelled)),
               Error);
}

}  // namespace
}  // namespace packmerger
