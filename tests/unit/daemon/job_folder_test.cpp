#include "delivery/job_folder.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>

#include "base/error.h"
#include "delivery/send.h"
#include "fixtures/fault_of.h"

namespace packmerger {
namespace {

using fixtures::fault_of;

void write(const fs::path& path, const std::string& text) { std::ofstream(path) << text; }

const char* const kReport = R"({"version": 1, "variant": "packed",
  "inputs": [{"file": "bunny.stl", "sha256": "ab", "scale": 1}],
  "parts": [{"id": 1, "tray": 1}, {"id": 2, "tray": 2}],
  "estimates": {"packed": {"fits": true, "time_s": 1, "cost": 1.5}}})";

// A job folder of two trays for the given profile.
void make_job(const fs::path& folder, const std::string& profile) {
  fs::create_directories(folder);
  write(folder / "job.json", kReport);
  write(folder / "profile.toml", profile_toml(read_profile(profile)));
  write(folder / "preview.png", "picture");
  for (const char* name : {"tray.stl", "tray-2.stl", "program.gcode", "program-2.gcode"})
    write(folder / name, std::string("G28 ; ") + name + "\n");
}

TEST(JobFolder, ReadsTheReport) {
  const TemporaryFolder folder;
  write(folder.path() / "job.json", kReport);
  const PreparedJob job = read_prepared(folder.path());
  EXPECT_EQ(job.trays, 2);
  EXPECT_EQ(job.title, "bunny");
  EXPECT_EQ(job.input_sha256, "ab");
  EXPECT_EQ(job.variant, "packed");
  EXPECT_EQ(doubt_about(job), "");
}

TEST(JobFolder, OnlyWarningsOfSizeAndShapeAreDoubtsAboutAModel) {
  const TemporaryFolder folder;
  const auto doubt = [&](const std::string& warnings) {
    std::string report = kReport;
    write(folder.path() / "job.json", report.insert(1, R"("warnings": [)" + warnings + "], "));
    return doubt_about(read_prepared(folder.path()));
  };
  const std::string repaired = R"({"code": "repaired", "text": "3 holes filled"})";
  EXPECT_EQ(doubt(""), "");
  EXPECT_EQ(doubt(repaired), "");
  EXPECT_EQ(doubt(repaired + R"(, {"code": "suspicious_size", "text": "it measures 2 mm"})"),
            "it measures 2 mm");
  EXPECT_EQ(doubt(repaired + R"(, {"code": "shape_changed", "text": "its area by 9 %"})"),
            "its area by 9 %");
}

TEST(JobFolder, EveryDoubtAboutAProgramButWhatWasLeftOut) {
  const TemporaryFolder folder;
  const auto doubt = [&](const std::string& code) {
    const std::string warning = R"({"code": ")" + code + R"(", "text": "line 3"})";
    write(folder.path() / "job.json",
          R"({"version": 1, "variant": "program", "inputs": [{"file": "a", "sha256": "x"}],
              "parts": [], "estimates": {}, "warnings": [)" +
              warning + "]}");
    return doubt_about(read_prepared(folder.path()));
  };
  EXPECT_EQ(doubt("moves_not_judged"), "line 3");
  EXPECT_EQ(doubt("left_out"), "");
  EXPECT_EQ(doubt("fan_full"), "");
}

TEST(JobFolder, RefusesWhatIsNoReport) {
  const TemporaryFolder folder;
  EXPECT_EQ(fault_of([&] { read_prepared(folder.path()); }), Fault::kNoInput);
  for (const char* text :
       {"", "[]", "{", "{\"version\": 2}", "{\"version\": 1}",
        R"({"version": 1, "inputs": [], "parts": [], "estimates": {}})",
        R"({"version": 1, "inputs": [{"file": 1, "sha256": "x"}], "parts": [], "estimates": {}})",
        R"({"version": 1, "inputs": [{"file": "a", "sha256": "x"}], "parts": [{"tray": 99999999}],
            "estimates": {}})"}) {
    write(folder.path() / "job.json", text);
    EXPECT_EQ(fault_of([&] { read_prepared(folder.path()); }), Fault::kBadInput) << text;
  }
}

TEST(Doubt, NoneWherePackingIsCheaperThanEveryOtherWayThatFits) {
  const auto pays = [](const std::string& estimates, const std::string& variant) {
    PreparedJob job;
    job.variant = variant;
    job.estimates = estimates;
    return doubt_about(job).empty();
  };
  const std::string cheap =
      R"({"packed": {"fits": true, "time_s": 1, "cost": 5},
          "hollow": {"fits": true, "time_s": 1, "cost": 6},
          "solid": {"fits": false, "cost": null}, "as_is": {"fits": false, "cost": null}})";
  EXPECT_TRUE(pays(cheap, "packed"));
  EXPECT_FALSE(pays(cheap, "hollow"));
  EXPECT_FALSE(pays(cheap, "solid")) << "it does not even fit";
  const auto solid_at = [](const std::string& cost) {
    return R"({"packed": {"fits": true, "time_s": 1, "cost": 5},
               "solid": {"fits": true, "time_s": 1, "cost": )" +
           cost + "}}";
  };
  EXPECT_FALSE(pays(solid_at("5"), "packed")) << "glued for nothing";
  EXPECT_TRUE(pays(solid_at("4"), "solid")) << "the cheapest way";
  EXPECT_TRUE(pays(
      R"({"packed": {"fits": true, "time_s": 1, "cost": 5}, "solid": {"fits": false}})", "packed"));
  EXPECT_FALSE(pays(R"({"packed": {"fits": true, "time_s": 1, "cost": 5},
                        "hollow": {"fits": false, "reason": "it cannot be sliced", "hint": "Turn it."},
                        "solid": {"fits": true, "time_s": 1, "cost": 8}})",
                    "packed"))
      << "hollow might cost less";
  for (const char* text : {"", "[]", "{}", R"({"packed": null})", R"({"packed": {"fits": true}})"})
    EXPECT_FALSE(pays(text, "packed")) << text;
}

TEST(Doubt, SaysWhatWasComparedAndChosen) {
  const auto doubt = [](const std::string& variant, double packed, double solid, double hollow,
                        int parts) {
    PreparedJob job;
    job.variant = variant;
    job.estimates = fmt::format(
        R"({{"packed": {{"fits": true, "time_s": 1, "cost": {}, "parts": {}}},
            "as_is": {{"fits": false}}, "solid": {{"fits": true, "time_s": 1, "cost": {}}},
            "hollow": {{"fits": true, "time_s": 1, "cost": {}}}}})",
        packed, parts, solid, hollow);
    return doubt_about(job);
  };
  EXPECT_EQ(doubt("packed", 5, 7, 6, 4), "");
  EXPECT_EQ(doubt("packed", 7, 7, 6, 4), "packing does not pay: printed hollow it costs less");
  EXPECT_EQ(doubt("packed", 7, 6, 8, 4), "packing does not pay: printed solid it costs less");
  EXPECT_EQ(doubt("packed", 7, 6.998, 8, 4),
            "packing does not pay: printed solid it costs as little");
  EXPECT_EQ(doubt("packed", 7, 7, 8, 1), "it is in one piece, with nothing to pack");
  EXPECT_EQ(doubt("packed", 7, 8, 6, 1),
            "it is in one piece, with nothing to pack: printed hollow it costs less");
  EXPECT_EQ(doubt("solid", 5, 7, 6, 4), "prepared solid: printed packed it costs less");
  EXPECT_EQ(doubt("solid", 8, 7, 6, 4), "prepared solid: printed hollow it costs less");
  EXPECT_EQ(doubt("hollow", 7, 8, 6, 4), "") << "the cheapest way";
  EXPECT_EQ(doubt("solid", 7, 7, 7, 4), "") << "none is cheaper";
  PreparedJob job;
  job.variant = "hollow";
  job.estimates =
      R"({"packed": {"fits": false}, "hollow": {"fits": true, "time_s": 1, "cost": 5}})";
  EXPECT_EQ(doubt_about(job), "") << "it could not be packed";
  job.variant = "packed";
  job.estimates =
      R"({"packed": {"fits": true, "time_s": 9, "cost": 4, "parts": 3, "material_cost": 4},
                      "hollow": {"fits": true, "time_s": 5, "cost": 5, "material_cost": 5}})";
  EXPECT_EQ(doubt_about(job), "packing does not pay: printed hollow it takes less time");
  job.variant = "hollow";
  job.estimates = "{}";
  EXPECT_EQ(doubt_about(job), "prepared hollow: what it costs is not known");
  job.variant = kProgramVariant;
  job.warning = "a move leaves the build volume";
  EXPECT_EQ(doubt_about(job), job.warning);
}

TEST(HandOver, PutsTheDocumentReportAndPictureWhole) {
  const TemporaryFolder folder;
  make_job(folder.path() / "job", "objet30");
  const fs::path to = folder.path() / "share";
  EXPECT_EQ(fault_of([&] { hand_over(folder.path() / "job", to, "bunny-1"); }),
            Fault::kCannotWrite);
  try {
    hand_over(folder.path() / "job", to / "", "bunny-1");
    ADD_FAILURE() << "there is no such folder";
  } catch (const Error& error) {
    EXPECT_EQ(error.what(), to.string() + "/ is no folder that can be written to")
        << "named as it was given";
  }
  fs::create_directory(to);
  const mode_t umask_before = ::umask(0077);
  const fs::path target = hand_over(folder.path() / "job", to, "bunny-1");
  ::umask(umask_before);
  EXPECT_EQ(fs::status(target).permissions(), fs::perms{0755}) << "another user takes it";
  EXPECT_EQ(fs::status(target / "job.json").permissions(), fs::perms{0644});
  EXPECT_EQ(target, to / "bunny-1");
  for (const char* name : {"job.json", "preview.png", "tray.stl", "tray-2.stl"})
    EXPECT_EQ(read_file(target / name, 9999), read_file(folder.path() / "job" / name, 9999));
  EXPECT_EQ(std::distance(fs::directory_iterator(target), {}), 4);
  EXPECT_EQ(std::distance(fs::directory_iterator(to), {}), 1) << "nothing temporary is left";
  EXPECT_EQ(hand_over(folder.path() / "job", to, "bunny-1"), target) << "the same job again";
  write(folder.path() / "job/job.json", std::string(kReport) + " ");
  EXPECT_EQ(fault_of([&] { hand_over(folder.path() / "job", to, "bunny-1"); }), Fault::kCannotWrite)
      << "another job of that name";
}

TEST(HandOver, AFailureLeavesNothingBehind) {
  const TemporaryFolder folder;
  make_job(folder.path() / "job", "objet30");
  fs::remove(folder.path() / "job/tray-2.stl");
  fs::create_directory(folder.path() / "share");
  const auto told = [&] {
    try {
      hand_over(folder.path() / "job", folder.path() / "share", "x");
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_NE(told(), "");
  EXPECT_EQ(told(), told()) << "so that it is one line in the log";
  EXPECT_TRUE(fs::is_empty(folder.path() / "share"));
}

TEST(SendTray, RefusesBeforeItOpensAnything) {
  const TemporaryFolder folder;
  PrintControl control;
  const auto send = [&](const fs::path& job, int tray, const std::string& port) {
    return fault_of([&] { send_tray(job, tray, port, job / "sent.progress", {}, control); });
  };
  make_job(folder.path() / "wire", "marlin");
  make_job(folder.path() / "folder", "uprint");
  const std::string none = (folder.path() / "no-port").string();
  EXPECT_EQ(send(folder.path() / "nothing", 1, none), Fault::kNoInput);
  EXPECT_EQ(send(folder.path() / "folder", 1, none), Fault::kUsage);
  EXPECT_EQ(send(folder.path() / "wire", 3, none), Fault::kNoInput);
  EXPECT_EQ(send(folder.path() / "wire", 0, none), Fault::kNoInput);
  EXPECT_EQ(send(folder.path() / "wire", 2, none), Fault::kUnavailable);
  write(folder.path() / "wire/program.gcode", "G1 X10\xFF\n");
  EXPECT_EQ(send(folder.path() / "wire", 1, none), Fault::kBadInput);
  EXPECT_EQ(fault_of([&] { hand_over(folder.path() / "wire", folder.path(), "x"); }),
            Fault::kUsage);
}

}  // namespace
}  // namespace packmerger
