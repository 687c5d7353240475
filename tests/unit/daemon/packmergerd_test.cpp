// The real daemon, with a stand-in for packmerger prepare and simulated printers.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <functional>
#include <future>
#include <thread>

#include "base/files.h"
#include "base/process.h"
#include "daemon/client.h"
#include "firmware_io/simulated/simulator.h"
#include "model/printer.h"

namespace packmerger {
namespace {

using nlohmann::json;
using testing::HasSubstr;

constexpr int kPatience_s = 60;

bool wait_until(const std::function<bool()>& holds) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(kPatience_s);
  while (std::chrono::steady_clock::now() < end) {
    if (holds()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  return false;
}

// A Marlin that prints as fast as it is told to, or at its own speed.
class SimulatedMarlin {
 public:
  SimulatedMarlin(double speed, const fs::path& record) {
    std::promise<std::string> promise;
    std::future<std::string> listening = promise.get_future();
    SimulatorOptions options;
    options.speed = speed;
    options.record = record;
    thread_ = std::thread([this, options, promise = std::move(promise)]() mutable {
      run_simulated_marlin(
          options, {}, [&](const std::string& path) { promise.set_value(path); }, stop_);
    });
    port_ = listening.get();
  }
  ~SimulatedMarlin() {
    stop_ = true;
    thread_.join();
  }
  const std::string& port() const { return port_; }

 private:
  std::atomic<bool> stop_{false};
  std::string port_;
  std::thread thread_;
};

class PackmergerdTest : public testing::Test {
 protected:
  void SetUp() override {
    const char* source = std::getenv("PACKMERGER_SOURCE");
    const char* programs = std::getenv("PACKMERGER_BIN");
    if (source == nullptr || programs == nullptr)
      GTEST_SKIP() << "PACKMERGER_SOURCE and PACKMERGER_BIN are not set; run it with ctest";
    source_ = source;
    program_ = fs::path(programs) / "packmergerd";
    Profile profile = read_profile("marlin");
    profile.link.boot_wait_s = 0;
    std::ofstream(path("quick.toml")) << profile_toml(profile);
    fs::create_directory(path("share"));
  }

  fs::path path(const std::string& name) const { return folder_.path() / name; }

  void configure(const std::string& port, bool simulated = true) {
    std::ofstream(path("d.toml"))
        << "state = \"state\"\nretry_s = 1\n[prepare]\nprogram = \""
        << (source_ / "tests/unit/daemon/fake_prepare.py").string()
        << "\"\nnice = 0\n[watch]\nstill_s = 0.2\ngive_up_s = 2\n"
        << "rescan_s = 1\n[printer.m]\nprofile = \"quick.toml\"\nport = \"" << port
        << "\"\napprove = \"auto\"\nsimulated = " << (simulated ? "true" : "false")
        << "\n[printer.o]\nprofile = \"objet30\"\nhandoff_folder = "
           "\"share\"\napprove = \"auto\"\n";
  }

  void start() {
    ProcessSpec spec;
    spec.argv = {program_.string(), "--config", path("d.toml").string()};
    spec.set_env = {{"PACKMERGER_SOURCE", source_.string()}};
    daemon_ = std::make_unique<ChildProcess>(spec);
    ASSERT_TRUE(wait_until([&] { return fs::exists(socket()) && answers(); })) << messages();
  }

  // The exit status after a signal.
  ExitStatus end(int signal) {
    ::kill(daemon_->pid(), signal);
    std::optional<ExitStatus> status;
    EXPECT_TRUE(wait_until([&] {
      messages();
      return (status = daemon_->poll()).has_value();
    }));
    const ExitStatus result = status.value_or(ExitStatus{-1, -1});
    EXPECT_EQ(messages().find("WARNING: ThreadSanitizer"), std::string::npos) << messages_;
    daemon_.reset();
    return result;
  }

  const std::string& messages() {
    std::vector<char> block(65536);
    for (ssize_t count = 1; daemon_ && count > 0;) {
      count = ::read(daemon_->err_fd(), block.data(), block.size());
      if (count > 0) messages_.append(block.data(), static_cast<std::size_t>(count));
    }
    return messages_;
  }

  fs::path socket() const { return path("state/packmergerd.sock"); }
  json ask(const json& request) { return ask_daemon(socket(), request); }
  bool answers() {
    try {
      return ask({{"verb", "printers.list"}}).is_array();
    } catch (const Error&) {
      return false;
    }
  }

  json job(int id) {
    try {
      return ask({{"verb", "jobs.show"}, {"id", id}});
    } catch (const Error&) {
      return {{"state", "none"}};
    }
  }
  bool reaches(int id, const std::string& state) {
    const bool reached = wait_until([&] { return job(id).at("state") == state; });
    EXPECT_TRUE(reached) << job(id).dump(2) << messages();
    return reached;
  }

  // A model written under a temporary name; a binary STL of one triangle.
  void drop(const std::string& printer, const std::string& name) {
    const fs::path target = path("state/folders") / printer / name;
    std::string bytes(134, '\0');
    bytes[80] = 1;
    bytes.replace(0, name.size(), name);
    std::ofstream(target.string() + ".part", std::ios::binary) << bytes;
    fs::rename(target.string() + ".part", target);
  }

  std::string without_comments(const fs::path& file) {
    std::ifstream stream(file);
    std::string all;
    for (std::string line; std::getline(stream, line);) all += line + "\n";
    return all;
  }

  fs::path source_;
  fs::path program_;
  TemporaryFolder folder_;
  std::unique_ptr<ChildProcess> daemon_;
  std::string messages_;
};

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

TEST_F(PackmergerdTest, OneStateFolderOneDaemon) {
  configure("/nonexistent/port");
  start();
  const ProcessResult second = run_process(
      {{program_.string(), "--config", path("d.toml").string()}, {}, {}, {}, 0, 0}, 30, {});
  EXPECT_EQ(second.status.code, 75);
  EXPECT_THAT(second.err, HasSubstr("Another packmergerd works"));
  EXPECT_TRUE(answers());
  EXPECT_EQ(end(SIGTERM).code, 0);
}

TEST_F(PackmergerdTest, BadSettingsAreToldWithTheLine) {
  const auto code = [&](const std::string& text) {
    std::ofstream(path("bad.toml")) << text;
    return run_process(
               {{program_.string(), "--config", path("bad.toml").string()}, {}, {}, {}, 0, 0}, 30,
               {})
        .status.code;
  };
  EXPECT_EQ(code("nonsense = 1\n"), 78);
  EXPECT_EQ(code("[prepare]\nprogram = \"/nonexistent\"\n[printer.o]\nprofile = "
                 "\"objet30\"\nhandoff_folder = \"/tmp\"\n"),
            78);
  EXPECT_EQ(run_process({{program_.string(), "--wrong"}, {}, {}, {}, 0, 0}, 30, {}).status.code, 2);
  EXPECT_EQ(
      run_process({{program_.string(), "--config", "/none"}, {}, {}, {}, 0, 0}, 30, {}).status.code,
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
  fs::create_symlink("/etc/passwd", path("state/folders/m/link.stl"));
  EXPECT_TRUE(
      wait_until([&] { return fs::exists(path("state/folders/m/failed/link.stl.reason.txt")); }));
  EXPECT_EQ(ask({{"verb", "jobs.list"}}).size(), 0U);
  EXPECT_EQ(end(SIGTERM).code, 0);
}

}  // namespace
}  // namespace packmerger
