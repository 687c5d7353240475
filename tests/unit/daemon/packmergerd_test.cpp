// The real daemon, with a stand-in for packmerger prepare and simulated printers.
#include "unit/daemon/running_daemon.h"

#include <algorithm>
#include <set>

namespace packmerger {
namespace {

using testing::HasSubstr;

using PackmergerdTest = RunningDaemon;

TEST_F(PackmergerdTest, PrintsWhatIsDropped) {
  SimulatedMarlin marlin(0, path("record"));
  configure(marlin.port());
  start();
  drop("m", "slow-bunny.stl");
  ASSERT_TRUE(reaches(1, "done"));
  const json done = job(1);
  const std::string program =
      without_comments(fs::path(done.at("folder").get<std::string>()) / "program.gcode");
  EXPECT_THAT(without_comments(path("record")), HasSubstr(program));
  const fs::path filed = path("state/folders/m/done/slow-bunny.stl");
  EXPECT_TRUE(wait_until([&] { return fs::exists(filed.string() + ".result.json"); }));
  EXPECT_TRUE(fs::exists(filed));

  drop("o", "statue.stl");
  ASSERT_TRUE(reaches(2, "handed_over"));
  EXPECT_TRUE(fs::exists(path("share/statue-2/tray.stl")));

  drop("m", "broken.stl");
  ASSERT_TRUE(reaches(3, "failed"));
  EXPECT_EQ(job(3).at("reason"), "The model has holes that cannot be closed");
  const fs::path reason = path("state/folders/m/failed/broken.stl.reason.txt");
  EXPECT_TRUE(wait_until([&] { return fs::exists(reason); }));
  EXPECT_THAT(read_file(reason, 1000), HasSubstr("Repair it in another program."));

  drop("m", "dear.stl");
  ASSERT_TRUE(reaches(4, "ready"));
  EXPECT_EQ(job(4).at("waits_for"), "approval");
  ask({{"verb", "jobs.approve"}, {"id", 4}});
  EXPECT_TRUE(reaches(4, "done"));
  EXPECT_EQ(end(SIGTERM).code, 0);
  EXPECT_FALSE(fs::exists(socket()));
}

TEST_F(PackmergerdTest, TheCheapestPrinterIsProposedAndNeverApprovedByItself) {
  SimulatedMarlin marlin(0, path("record"));
  configure(marlin.port());
  std::ofstream(path("d.toml"), std::ios::app) << "[printer.any]\nprofile = \"auto\"\n";
  start();
  drop("any", "statue.stl");
  ASSERT_TRUE(reaches(1, "ready"));
  EXPECT_EQ(job(1).at("printer"), "o") << "5 EUR against 8";
  EXPECT_EQ(job(1).at("chosen_by"), "any");
  EXPECT_EQ(job(1).at("waits_for"), "approval") << "though o approves by itself what it is given";
  ASSERT_EQ(job(1).at("choice").at("printers").size(), 2U);
  ask({{"verb", "jobs.approve"}, {"id", 1}});
  ASSERT_TRUE(reaches(1, "handed_over"));
  const fs::path filed = path("state/folders/any/done/statue.stl.result.json");
  ASSERT_TRUE(wait_until([&] { return fs::exists(filed); }));
  EXPECT_EQ(json::parse(read_file(filed, 100000)).at("choice"), job(1).at("choice"));

  drop("any", "only-quick.stl");
  ASSERT_TRUE(reaches(2, "ready"));
  EXPECT_EQ(job(2).at("printer"), "m") << "it does not fit the other one";
  ask({{"verb", "jobs.approve"}, {"id", 2}});
  EXPECT_TRUE(reaches(2, "done"));

  drop("any", "broken.stl");
  ASSERT_TRUE(reaches(3, "failed"));
  EXPECT_THAT(job(3).at("reason"), HasSubstr("none of the printers: m: It does not fit"));
  drop("any", "part.gcode");
  ASSERT_TRUE(reaches(4, "failed"));
  EXPECT_THAT(job(4).at("reason"), HasSubstr("made for one printer"));
  EXPECT_EQ(end(SIGTERM).code, 0);
}

TEST_F(PackmergerdTest, ARealBedIsClearedTrayByTray) {
  SimulatedMarlin marlin(0, path("record"));
  configure(marlin.port(), false);
  start();
  drop("m", "two.stl");
  ASSERT_TRUE(wait_until([&] { return job(1).value("waits_for", json()) == "clear_bed"; }));
  ask({{"verb", "printers.clear"}, {"name", "m"}});
  ASSERT_TRUE(wait_until([&] { return job(1).at("tray") == 2; }));
  EXPECT_EQ(job(1).at("waits_for"), "clear_bed");
  ask({{"verb", "printers.clear"}, {"name", "m"}});
  EXPECT_TRUE(reaches(1, "done"));
  EXPECT_EQ(end(SIGINT).code, 0);
}

TEST_F(PackmergerdTest, StoppingCancelsThePrintAndRestartDoesNotResumeIt) {
  SimulatedMarlin marlin(1, path("record"));
  configure(marlin.port());
  start();
  drop("m", "long.stl");
  ASSERT_TRUE(reaches(1, "sending"));
  ASSERT_TRUE(wait_until([&] { return job(1)["progress"].value("done", 0) > 2; }));
  drop("m", "hang.stl");
  ASSERT_TRUE(reaches(2, "preparing"));
  EXPECT_EQ(end(SIGTERM).code, 0);
  EXPECT_THAT(without_comments(path("record")), HasSubstr("M104 S0")) << "heaters off";
  start();
  EXPECT_EQ(job(1).at("state"), "failed");
  EXPECT_THAT(job(1).at("reason"), HasSubstr("the daemon was stopped while printing"));
  ASSERT_TRUE(reaches(2, "preparing"));
  ask({{"verb", "jobs.cancel"}, {"id", 2}});
  EXPECT_EQ(job(2).at("state"), "cancelled");
  EXPECT_TRUE(wait_until([&] { return fs::exists(path("state/folders/m/failed/hang.stl")); }));
  EXPECT_EQ(end(SIGTERM).code, 0);
}

TEST_F(PackmergerdTest, AKilledDaemonLosesNothing) {
  configure("/nonexistent/port");
  start();
  for (const char* name : {"a.stl", "b.stl", "c.stl", "slow.stl"}) drop("m", name);
  ASSERT_TRUE(reaches(2, "preparing") || reaches(2, "approved"));
  end(SIGKILL);
  drop("m", "d.stl");
  start();
  for (int id = 1; id <= 5; ++id) EXPECT_TRUE(reaches(id, "approved"));
  EXPECT_EQ(job(5).at("waits_for"), "not_connected");
  EXPECT_EQ(end(SIGTERM).code, 0);
}

TEST_F(PackmergerdTest, CancellingAPrintStopsIt) {
  SimulatedMarlin marlin(1, path("record"));
  configure(marlin.port());
  start();
  drop("m", "long.stl");
  ASSERT_TRUE(wait_until(
      [&] { return job(1)["progress"].is_object() && job(1)["progress"].value("done", 0) > 2; }));
  ask({{"verb", "jobs.cancel"}, {"id", 1}});
  EXPECT_TRUE(reaches(1, "cancelled"));
  EXPECT_EQ(end(SIGTERM).code, 0);
}

TEST_F(PackmergerdTest, AnswersWhileManyFilesArriveAtOnce) {
  constexpr std::size_t kFiles = 600;
  configure("/nonexistent/port");
  fs::create_directories(path("state/folders/o"));
  for (std::size_t i = 0; i < kFiles; ++i) drop("o", "m" + std::to_string(i) + ".stl");
  start();
  const auto count = [&] { return ask({{"verb", "jobs.list"}, {"limit", 1000}}).size(); };
  std::set<std::size_t> told;
  EXPECT_TRUE(wait_until([&] { return *told.insert(count()).first == kFiles; })) << messages();
  EXPECT_TRUE(std::any_of(told.begin(), told.end(), [](std::size_t jobs) {
    return jobs > 0 && jobs < kFiles;
  })) << "asked between one file and the next, not after the last";
  EXPECT_EQ(end(SIGTERM).code, 0);
}

TEST_F(PackmergerdTest, OneStateFolderOneDaemon) {
  configure("/nonexistent/port");
  start();
  const ProcessResult second = run_process(
      {{program_.string(), "--config", path("d.toml").string()}, {}, {}, {}, 0, 0, {}}, 30, {});
  EXPECT_EQ(second.status.code, 75);
  EXPECT_THAT(second.err, HasSubstr("Another packmergerd works"));
  EXPECT_TRUE(answers());
  EXPECT_EQ(end(SIGTERM).code, 0);
}

TEST_F(PackmergerdTest, BadSettingsAreToldWithTheLine) {
  const auto code = [&](const std::string& text) {
    std::ofstream(path("bad.toml")) << text;
    return run_process(
               {{program_.string(), "--config", path("bad.toml").string()}, {}, {}, {}, 0, 0, {}},
               30, {})
        .status.code;
  };
  EXPECT_EQ(code("nonsense = 1\n"), 78);
  EXPECT_EQ(code("[prepare]\nprogram = \"/nonexistent\"\n[printer.o]\nprofile = "
                 "\"objet30\"\nhandoff_folder = \"/tmp\"\n"),
            78);
  EXPECT_EQ(run_process({{program_.string(), "--wrong"}, {}, {}, {}, 0, 0, {}}, 30, {}).status.code,
            2);
  EXPECT_EQ(run_process({{program_.string(), "--config", "/none"}, {}, {}, {}, 0, 0, {}}, 30, {})
                .status.code,
            66);
}

TEST_F(PackmergerdTest, SocketAbuseDoesNotDisturbIt) {
  configure("/nonexistent/port");
  start();
  std::vector<int> clients;
  for (int i = 0; i < 20; ++i) {
    const int fd = ::socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::strcpy(address.sun_path, socket().c_str());
    ASSERT_EQ(::connect(fd, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
    clients.push_back(fd);
  }
  const std::string garbage(100000, static_cast<char>(0xFE));
  for (int round = 0; round < 20; ++round) {
    for (const int fd : clients) ::send(fd, garbage.data(), garbage.size(), MSG_NOSIGNAL);
    ASSERT_TRUE(answers()) << round;
  }
  for (const int fd : clients) ::close(fd);
  EXPECT_TRUE(answers());
  EXPECT_EQ(end(SIGTERM).code, 0);
}

TEST_F(PackmergerdTest, TellsWhyItDoesNotTakeALink) {
  configure("/nonexistent/port");
  start();
  fs::create_directories(path("state/folders/m"));
  fs::create_symlink("/etc/passwd", path("state/folders/m/link.stl"));
  EXPECT_TRUE(
      wait_until([&] { return fs::exists(path("state/folders/m/failed/link.stl.reason.txt")); }));
  EXPECT_EQ(ask({{"verb", "jobs.list"}}).size(), 0U);
  EXPECT_EQ(end(SIGTERM).code, 0);
}

}  // namespace
}  // namespace packmerger
