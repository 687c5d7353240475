// Profiles as an opponent writes them: every shipped one loads, everything else is refused with
// its line.
#include "model/printer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>

#include "base/error.h"
#include "base/files.h"
#include "base/random.h"

namespace packmerger {
namespace {

using ::testing::HasSubstr;
using ::testing::MatchesRegex;

fs::path source_folder() {
  const char* source = std::getenv("PACKMERGER_SOURCE");
  return source == nullptr ? fs::path(".") : fs::path(source);
}

const std::vector<std::string> kShipped = {"fuse1",      "marlin", "objet30",
                                           "replicator", "uprint", "uprint-plus"};

std::string shipped_text(const std::string& id) {
  return read_file(source_folder() / "profiles" / (id + ".toml"), 1 << 20);
}

const std::string kSmall =
    "name = \"Small\"\ntechnology = \"fdm\"\ndialect = \"handoff\"\nbuild_mm = [100, 100, 100]\n"
    "layer_mm = 0.2\n";

class ProfileTest : public testing::Test {
 protected:
  fs::path write(const std::string& name, const std::string& text) const {
    write_file_whole(folder_.path() / name, text);
    return folder_.path() / name;
  }
  Profile read_text(const std::string& text) const {
    return read_profile(write("trial.toml", text).string());
  }
  // The message of the refusal, after checking its fault.
  std::string refusal(const std::string& text, Fault fault = Fault::kBadProfile) const {
    try {
      read_text(text);
    } catch (const Error& error) {
      EXPECT_EQ(error.fault(), fault) << error.what();
      EXPECT_FALSE(error.hint().empty());
      return error.what();
    }
    ADD_FAILURE() << "accepted:\n" << text;
    return {};
  }

  TemporaryFolder folder_;
};

TEST_F(ProfileTest, EveryShippedProfileIsFoundAndLoads) {
  EXPECT_THAT(profile_ids(), testing::IsSupersetOf(kShipped));
  for (const std::string& id : kShipped) {
    const Profile profile = read_profile((source_folder() / "profiles" / (id + ".toml")).string());
    EXPECT_EQ(profile.id, id);
    EXPECT_FALSE(profile.name.empty());
    EXPECT_EQ(profile.shape.segmentation, Segmentation::kPrinter);
    EXPECT_EQ(profile.pack.objective, Objective::kPrinter);
    EXPECT_GT(profile.cost.model_price_per_g, 0);
    const bool is_hobby = id == "marlin" || id == "replicator";  // rates are their owner's to set
    EXPECT_EQ(profile.cost.machine_price_per_h > 0, !is_hobby) << id;
    EXPECT_EQ(profile.cost.labour_price_per_h > 0, !is_hobby) << id;
    EXPECT_GT(profile.cost.clean_min_per_tray, 0) << "minutes by hand are told all the same";
  }
}

TEST_F(ProfileTest, EveryFigureOfAShippedProfileHasItsSource) {
  // A figure is a line "key = value"; its comment gives a source or says unverified. Inside the
  // slicer's table one comment may stand for the lines that follow it.
  for (const std::string& id : kShipped) {
    std::istringstream lines(shipped_text(id));
    std::string line;
    std::string table;
    bool in_text = false;
    while (std::getline(lines, line)) {
      if (line.find("\"\"\"") != std::string::npos) in_text = !in_text;
      if (line.starts_with("[")) table = line;
      const bool figure = line.find(" = ") != std::string::npos &&
                          line.find_first_of("0123456789") != std::string::npos;
      if (in_text || !figure || table == "[slicer.options]" || line.starts_with("#")) continue;
      if (line.starts_with("name") || line.starts_with("model_name") ||
          line.starts_with("support_name") || line.find("\"\"\"") != std::string::npos)
        continue;
      EXPECT_THAT(line, HasSubstr("# ")) << id;
    }
  }
}

TEST_F(ProfileTest, TheNamedMachinesHaveTheirVolumes) {
  const auto build = [](const std::string& id) {
    return read_profile((source_folder() / "profiles" / (id + ".toml")).string()).build();
  };
  EXPECT_EQ(build("uprint"), Vec3(203, 152, 152));
  EXPECT_EQ(build("uprint-plus"), Vec3(203, 203, 152));
  EXPECT_EQ(build("marlin"), Vec3(220, 220, 250));
}

TEST_F(ProfileTest, WritingAndReadingIsTheIdentity) {
  for (const std::string& id : kShipped) {
    const Profile profile = read_profile((source_folder() / "profiles" / (id + ".toml")).string());
    const std::string text = profile_toml(profile);
    // The id survives a file of another name, as profile.toml in a job folder is.
    const Profile again = read_profile(write("profile.toml", text).string());
    EXPECT_EQ(again.id, id);
    EXPECT_EQ(profile_toml(again), text);
    EXPECT_EQ(again.slicer.start_gcode, profile.slicer.start_gcode);
    EXPECT_EQ(again.slicer.options, profile.slicer.options);
    EXPECT_EQ(again.pack.weight, profile.pack.weight);
  }
}

TEST_F(ProfileTest, HardTextsSurviveWriting) {
  Profile profile = read_text(kSmall);
  profile.name = "a \"quoted\" \\ name\twith Ünïcode";
  profile.slicer.start_gcode = "\n\"\"\" ; three quotes\\\r\nG1\n";
  profile.slicer.options["notes"] = "50% \\n \"";
  profile.cost.model_price_per_g = 0.1 + 0.2;
  const Profile again = read_profile(write("profile.toml", profile_toml(profile)).string());
  EXPECT_EQ(again.name, profile.name);
  EXPECT_EQ(again.slicer.start_gcode, profile.slicer.start_gcode);
  EXPECT_EQ(again.slicer.options, profile.slicer.options);
  EXPECT_EQ(again.cost.model_price_per_g, profile.cost.model_price_per_g);
}

TEST_F(ProfileTest, RefusalsNameFileLineAndWhatWasExpected) {
  EXPECT_THAT(refusal(kSmall + "gap_mm = \"wide\"\n"),
              MatchesRegex(".*trial.toml:6: gap_mm: expected number, 0 to 50 \\(mm\\)"));
  EXPECT_THAT(refusal(kSmall + "gap_mm = 51\n"), HasSubstr(":6: gap_mm: expected"));
  EXPECT_THAT(refusal(kSmall + "gap_mm = nan\n"), HasSubstr(":6: gap_mm: expected"));
  EXPECT_THAT(refusal(kSmall + "gap_mm = true\n"), HasSubstr(":6: gap_mm: expected"));
  EXPECT_THAT(refusal(kSmall + "gap_mn = 1\n"), HasSubstr(":6: there is no key \"gap_mn\""));
  EXPECT_THAT(refusal(kSmall + "[fdm]\nshells = 2.5\n"), HasSubstr(":7: fdm.shells: expected"));
  EXPECT_THAT(refusal(kSmall + "[fdm]\nshell = 2\n"),
              HasSubstr(":7: there is no key \"fdm.shell\""));
  EXPECT_THAT(refusal(kSmall + "[fmd]\nshells = 2\n"), HasSubstr(":6: there is no key \"fmd\""));
  EXPECT_THAT(refusal(kSmall + "fdm = 3\n"), HasSubstr(":6: fdm must be a table"));
  EXPECT_THAT(refusal(kSmall + "objective = \"speed\"\n"),
              HasSubstr(":6: objective: expected one of paper, printer, height"));
  EXPECT_THAT(refusal(kSmall + "[cost]\ncurrency = \"pounds\"\n"), HasSubstr(":7: cost.currency"));
  EXPECT_THAT(refusal(kSmall + "[link]\nusb_ids = [\"23C1:D314\"]\n"),
              HasSubstr(":7: link.usb_ids"));
  EXPECT_THAT(refusal(kSmall + "[slicer.options]\nlayer_height = 0.2\n"),
              HasSubstr(":6: slicer.options: expected table of texts"));
  EXPECT_THAT(refusal(kSmall + "[slicer.options]\nnotes = \"a\\nstart_gcode = M104 S999\"\n"),
              HasSubstr(":6: slicer.options"));
  EXPECT_THAT(refusal(kSmall + "tetgen_flags = \"pY; rm\"\n"), HasSubstr(":6: tetgen_flags"));
  EXPECT_THAT(refusal(kSmall + "gap_mm = 1\ngap_mm = 1\n"), HasSubstr(":7: "));
  EXPECT_THAT(refusal(kSmall + "gap_mm =\n"), HasSubstr(":6: "));
  EXPECT_THAT(refusal("name = \"x\"\n"), HasSubstr(":1: the key technology is missing"));
  EXPECT_THAT(refusal(""), HasSubstr(":1: the key name is missing"));
  EXPECT_THAT(refusal(std::string(2 << 20, '#')), HasSubstr(":1: "));
}

TEST_F(ProfileTest, AbilitiesDemandWhatTheyNeed) {
  EXPECT_THAT(refusal("name=\"P\"\ntechnology=\"polyjet\"\ndialect=\"handoff\"\n"
                      "build_mm=[1,1,1]\nlayer_mm=0.1\n"),
              HasSubstr("polyjet.layer_s"));
  EXPECT_THAT(refusal(kSmall + "[fdm]\ntime=\"deposition\"\n"), HasSubstr("deposition_cm3_h"));
  EXPECT_THAT(refusal("name=\"P\"\ntechnology=\"fdm\"\ndialect=\"gcode\"\nbuild_mm=[1,1,1]\n"
                      "layer_mm=0.1\n"),
              HasSubstr("slicer.start_gcode"));
  EXPECT_THAT(refusal("name=\"P\"\ntechnology=\"fdm\"\ndialect=\"s3g\"\nbuild_mm=[1,1,1]\n"
                      "layer_mm=0.1\n[slicer]\nstart_gcode=\"a\"\nend_gcode=\"b\"\n"),
              HasSubstr("slicer.gpx_machine"));
}

TEST_F(ProfileTest, ABaseIsOneProfileAndNoMore) {
  write("parent.toml",
        kSmall + "gap_mm = 2\n[slicer.options]\nskirts = \"1\"\nperimeters = \"2\"\n");
  const Profile child =
      read_text("base = \"parent\"\nname = \"Child\"\n[slicer.options]\nskirts = \"3\"\n");
  EXPECT_EQ(child.name, "Child");
  EXPECT_EQ(child.id, "trial");
  EXPECT_EQ(child.pack.gap_mm, 2);
  EXPECT_EQ(child.slicer.options.at("skirts"), "3");
  EXPECT_EQ(child.slicer.options.at("perimeters"), "2");

  EXPECT_THAT(refusal("# a line\nbase = \"nowhere\"\n"), HasSubstr(":2: the base profile"));
  EXPECT_THAT(refusal("base = \"trial\"\n" + kSmall), HasSubstr(":1: a base may not"));
  EXPECT_THAT(refusal("base = \"../parent\"\n"), HasSubstr(":1: base must be"));
  EXPECT_THAT(refusal("base = 7\n"), HasSubstr(":1: base must be"));
  write("grandchild.toml", "base = \"child\"\n");
  write("child.toml", "base = \"parent\"\n");
  EXPECT_THROW(read_profile((folder_.path() / "grandchild.toml").string()), Error);
  // An error in the base is reported with the base's own file and line.
  write("parent.toml", kSmall + "gap_mm = -1\n");
  EXPECT_THAT(refusal("base = \"parent\"\n"), HasSubstr("parent.toml:6: gap_mm"));
}

TEST_F(ProfileTest, ProfilesAreLookedForInOrder) {
  setenv("PACKMERGER_PROFILES", folder_.path().c_str(), 1);
  write("objet30.toml", kSmall);
  write("mine.toml", kSmall);
  write("wrong.toml", "id = \"other\"\n" + kSmall);
  EXPECT_EQ(read_profile("objet30").name, "Small");
  EXPECT_EQ(read_profile("mine").id, "mine");
  EXPECT_THAT(profile_ids(), testing::Contains("mine"));
  EXPECT_THROW(read_profile("wrong"), Error);
  unsetenv("PACKMERGER_PROFILES");
  for (const std::string missing : {"no-such", "", "a b", ".hidden"}) {
    try {
      read_profile(missing);
      ADD_FAILURE() << missing;
    } catch (const Error& error) {
      EXPECT_EQ(error.fault(), Fault::kNoInput);
    }
  }
}

TEST_F(ProfileTest, SetMayNotTakeAwayWhatAbilitiesNeed) {
  Profile profile = read_text(kSmall);
  check_settings(profile);
  set_profile_key(profile, "dialect=gcode");
  EXPECT_THROW(check_settings(profile), Error);
  set_profile_key(profile, "slicer.start_gcode=G28");
  set_profile_key(profile, "slicer.end_gcode=M84");
  check_settings(profile);
}

TEST_F(ProfileTest, SetTakesWhatAProfileTakes) {
  Profile profile = read_text(kSmall);
  set_profile_key(profile, "build_mm=100,100,300");
  set_profile_key(profile, "gap_mm=0");
  set_profile_key(profile, "objective=height");
  set_profile_key(profile, "fdm.start_s=60");
  set_profile_key(profile, "slicer.options.skirts=2");
  set_profile_key(profile, "link.usb_ids=1a86:7523,23c1:d314");
  set_profile_key(profile, "name=A = B");
  EXPECT_EQ(profile.build(), Vec3(100, 100, 300));
  EXPECT_EQ(profile.pack.gap_mm, 0);
  EXPECT_EQ(profile.pack.objective, Objective::kHeight);
  EXPECT_EQ(profile.fdm.start_s, 60);
  EXPECT_EQ(profile.slicer.options.at("skirts"), "2");
  EXPECT_EQ(profile.link.usb_ids.size(), 2U);
  EXPECT_EQ(profile.name, "A = B");

  const std::string before = profile_toml(profile);
  for (const std::string bad : {"gap_mm",
                                "gap_mm=",
                                "gap_mm=x",
                                "gap_mm=1x",
                                "gap_mm= 1",
                                "gap_mm=-1",
                                "gap_mm=nan",
                                "gap_mm=inf",
                                "gap_mm=1e400",
                                "clusters=1.5",
                                "clusters=0",
                                "clusters=99999999999999999999",
                                "build_mm=1,2",
                                "build_mm=1,2,3,4",
                                "build_mm=1,,3",
                                "build_mm=0,1,1",
                                "objective=",
                                "=1",
                                "",
                                "no_such=1",
                                "fdm=1",
                                "slicer.options=1",
                                "slicer.options.=1",
                                "slicer.options.A B=1",
                                "slicer.options.a=b\nc",
                                "name=\xff\xfe",
                                "base=uprint",
                                "cost.currency=eur",
                                "id=a/b",
                                "id="}) {
    try {
      set_profile_key(profile, bad);
      ADD_FAILURE() << "accepted " << bad;
    } catch (const Error& error) {
      EXPECT_EQ(error.fault(), Fault::kUsage) << bad;
      EXPECT_FALSE(error.hint().empty());
    }
  }
  EXPECT_EQ(profile_toml(profile), before);
}

TEST_F(ProfileTest, APlateIsASimplePolygonOnTheTray) {
  Profile profile =
      read_text(kSmall +
                "plate_mm = [[50, 0], [100, 50.5], [0, 50]]\n"
                "keep_out_mm = [[[0, 0], [9, 0], [9, 9]], [[90, 90], [120, 90], [90, 99]]]\n");
  EXPECT_EQ(profile.plate_mm.size(), 3U);
  EXPECT_EQ(profile.plate_mm[1], Vec2(100, 50.5));
  ASSERT_EQ(profile.keep_out_mm.size(), 2U);
  EXPECT_EQ(profile.keep_out_mm[1][1], Vec2(120, 90));
  EXPECT_EQ(profile_toml(read_text(profile_toml(profile))), profile_toml(profile));

  set_profile_key(profile, "plate_mm=0x0,100x0,50.5x99");
  EXPECT_EQ(profile.plate_mm[2], Vec2(50.5, 99));
  set_profile_key(profile, "keep_out_mm=0x0,9x0,9x9;20x20,29x20,29x29;40x40,49x40,49x49");
  EXPECT_EQ(profile.keep_out_mm.size(), 3U);
  check_settings(profile);
  set_profile_key(profile, "plate_mm=");
  set_profile_key(profile, "keep_out_mm=");
  EXPECT_TRUE(profile.plate().is_whole());
  EXPECT_THROW(set_profile_key(profile, "plate_mm=1,2,3"), Error);
  EXPECT_THROW(set_profile_key(profile, "plate_mm=0x0,nanx1,1x1"), Error);

  const auto refused = [&](const std::string& line) { return refusal(kSmall + line + "\n"); };
  EXPECT_THAT(refused("plate_mm = [[0, 0], [50, 50], [50, 0], [0, 50]]"), HasSubstr("meet"));
  EXPECT_THAT(refused("plate_mm = [[0, 0], [50, 50]]"), HasSubstr("2 corners"));
  EXPECT_THAT(refused("plate_mm = [[-50, 0], [50, 50], [50, 0]]"),
              HasSubstr("corner 1 is at -50, 0"));
  EXPECT_THAT(refused("plate_mm = [[0, 0, 0], [50, 50, 0], [50, 0, 0]]"), HasSubstr("points"));
  EXPECT_THAT(refused("plate_mm = [[[0, 0], [50, 50], [50, 0]]]"), HasSubstr("points"));
  EXPECT_THAT(refused("plate_mm = [1, 2]"), HasSubstr("points"));
  EXPECT_THAT(refused("keep_out_mm = [[[0, 0], [5, 0], [9, 0]]]"), HasSubstr("no area"));
  EXPECT_THAT(refused("keep_out_mm = [[[200, 0], [205, 0], [209, 9]]]"),
              HasSubstr("area 1 lies outside of build_mm"));
}

TEST_F(ProfileTest, PowderNeedsNoSupportAndNoSlicer) {
  const auto refused = [&](const std::string& support, const std::string& rest) {
    return refusal(
        "name=\"P\"\ntechnology=\"powder\"\nbuild_mm=[9,9,9]\nlayer_mm=0.1\n"
        "support_angle_deg=" +
        support + "\n" + rest);
  };
  EXPECT_THAT(refused("90", "dialect=\"handoff\"\n"), HasSubstr("powder.layer_s"));
  EXPECT_THAT(refused("45", "dialect=\"handoff\"\n[powder]\nlayer_s=9\n"),
              HasSubstr("support_angle_deg must be 90"));
  EXPECT_THAT(refused("90", "dialect=\"gcode\"\n[powder]\nlayer_s=9\n"), HasSubstr("dialect"));
  const Profile fuse = read_profile("fuse1");
  EXPECT_EQ(fuse.technology, Technology::kPowder);
  EXPECT_EQ(fuse.pack.placement, Placement::kAnywhere);
}

// Cuts, swaps and foreign bytes in a real profile: it is read, or refused with file and line.
TEST_F(ProfileTest, MutatedProfilesNeverEndInAnythingElse) {
  const std::string original = shipped_text("replicator");
  const std::string interesting = "\"'[]{}=.,#\n\r\t\\-+0e9\xff\xc3\x00n_ifu";
  Random random(20120712);
  int refused = 0;
  for (int round = 0; round < 1500; ++round) {
    std::string text = original;
    for (std::size_t change = random.below(4) + 1; change > 0; --change) {
      const std::size_t at = random.below(text.size());
      switch (random.below(5)) {
        case 0:
          text[at] = interesting[random.below(interesting.size())];
          break;
        case 1:
          text.erase(at, random.below(40) + 1);
          break;
        case 2:
          text.insert(at, text.substr(random.below(text.size()), random.below(60)));
          break;
        case 3:
          text[at] = static_cast<char>(random.below(256));
          break;
        default:
          text.resize(at + 1);
          break;
      }
    }
    const fs::path path = folder_.path() / "trial.toml";
    { std::ofstream(path, std::ios::binary) << text; }
    try {
      profile_toml(read_profile(path.string()));
    } catch (const Error& error) {
      ++refused;
      ASSERT_EQ(error.fault(), Fault::kBadProfile) << error.what() << "\n" << text;
      const std::string what = error.what();
      const std::size_t colon = what.find("trial.toml:");
      ASSERT_NE(colon, std::string::npos) << what;
      ASSERT_GT(std::atoi(what.c_str() + colon + 11), 0) << what;
    }
  }
  EXPECT_GT(refused, 300);
}

TEST_F(ProfileTest, DeepAndWideTomlIsRefused) {
  refusal("name = " + std::string(100000, '['));
  refusal(kSmall + "x" + std::string(100000, 'y') + " = 1\n");
  std::string many = kSmall + "build_mm = [";
  for (int i = 0; i < 50000; ++i) many += "1,";
  refusal(many + "1]\n");
}

TEST_F(ProfileTest, TextsForThePrinterAreWhatItsLineCanHold) {
  const auto with = [](const std::string& key, const std::string& text) {
    return kSmall + "[link]\n" + key + " = \"" + text + "\"\n";
  };
  const std::string fits = "G1 X10 ; \u00FCber\\nM104 S0\\n" + std::string(81, 'G');
  for (const std::string key : {"safe_gcode", "pause_gcode", "resume_gcode"}) {
    EXPECT_NO_THROW(read_text(with(key, fits)));
    for (const std::string wrong : {"M117 f\u00FCr", "M117 M1100", "M110 N0"})
      EXPECT_THAT(refusal(with(key, wrong)), HasSubstr("link." + key));
    EXPECT_THAT(refusal(with(key, "M84\\n" + std::string(82, 'G'))), HasSubstr("link." + key));
  }
}

TEST(Profiles, AnyDocumentPrinterCanBeSetToUsb) {
  for (const char* id : {"objet30", "uprint"}) {
    Profile profile = read_profile(id);
    EXPECT_EQ(profile.dialect, Dialect::kHandoff) << id;
    set_profile_key(profile, "dialect=usb");
    set_profile_key(profile, "document=tray_3mf");
    set_profile_key(profile, "link.machine=Print bridge");
    EXPECT_NO_THROW(check_settings(profile)) << id;
    EXPECT_EQ(profile.dialect, Dialect::kUsb);
    EXPECT_EQ(profile.link.machine, "Print bridge");
    EXPECT_FALSE(profile.is_sliced());
  }
}

}  // namespace
}  // namespace packmerger
