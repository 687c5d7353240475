// The real daemon, and somebody who changes a prepared program behind its back.
#include "unit/daemon/running_daemon.h"

namespace packmerger {
namespace {

using testing::HasSubstr;
using testing::Not;

using ChangedProgramTest = RunningDaemon;

TEST_F(ChangedProgramTest, IsNotSentAndTheNextJobFindsTheBedClear) {
  SimulatedMarlin marlin(0, path("record"));
  configure(marlin.port(), false);
  start();
  drop("m", "two.stl");
  ASSERT_TRUE(wait_until([&] { return job(1).value("waits_for", json()) == "clear_bed"; }));
  const fs::path folder = job(1).at("folder").get<std::string>();
  ASSERT_EQ(job(1).at("tray_files").size(), 2U);
  EXPECT_EQ(job(1).at("tray_files")[1].at("sha256"),
            sha256_hex_of_file(folder / "program-2.gcode"));
  ask({{"verb", "printers.clear"}, {"name", "m"}});
  ASSERT_TRUE(wait_until([&] { return job(1).at("tray") == 2; }));
  EXPECT_EQ(end(SIGKILL).signal, SIGKILL);
  std::ofstream(folder / "program-2.gcode", std::ios::app) << "G1 X77.7\n";

  start();
  ask({{"verb", "printers.clear"}, {"name", "m"}});
  ASSERT_TRUE(reaches(1, "failed"));
  EXPECT_THAT(job(1).at("reason"), HasSubstr("program-2.gcode, is not what was prepared"));
  EXPECT_EQ(ask({{"verb", "printers.list"}}).at(0).at("bed"), "clear");
  const fs::path reason = path("state/folders/m/failed/two.stl.reason.txt");
  ASSERT_TRUE(wait_until([&] { return fs::exists(reason); }));
  EXPECT_THAT(read_file(reason, 1000), HasSubstr("drop its file again"));

  drop("m", "next.stl");
  ASSERT_TRUE(reaches(2, "done")) << "on the same clear bed";
  const fs::path result = path("state/folders/m/done/next.stl.result.json");
  ASSERT_TRUE(wait_until([&] { return fs::exists(result); }));
  EXPECT_EQ(json::parse(read_file(result, 100000)).at("tray_files"), job(2).at("tray_files"));
  std::ofstream(fs::path(job(2).at("folder").get<std::string>()) / "program.gcode", std::ios::app)
      << "G1 X77.7\n";
  ask({{"verb", "printers.clear"}, {"name", "m"}});
  ask({{"verb", "jobs.again"}, {"id", 2}});
  ASSERT_TRUE(reaches(3, "failed"));
  EXPECT_EQ(job(3).at("tray_files"), job(2).at("tray_files"));
  EXPECT_EQ(end(SIGTERM).code, 0);
  EXPECT_THAT(without_comments(path("record")), Not(HasSubstr("X77.7")));
}

TEST_F(ChangedProgramTest, IsNotHandedOver) {
  configure("/nonexistent/port");
  start();
  ask({{"verb", "printers.pause"}, {"name", "o"}});
  drop("o", "statue.stl");
  ASSERT_TRUE(wait_until([&] { return job(1).value("waits_for", json()) == "paused"; }));
  std::ofstream(fs::path(job(1).at("folder").get<std::string>()) / "tray.stl") << "changed";
  ask({{"verb", "printers.resume"}, {"name", "o"}});
  ASSERT_TRUE(reaches(1, "failed"));
  EXPECT_THAT(job(1).at("reason"), HasSubstr("tray.stl, is not what was prepared"));
  EXPECT_TRUE(fs::is_empty(path("share")));
  EXPECT_EQ(end(SIGTERM).code, 0);
}

}  // namespace
}  // namespace packmerger
