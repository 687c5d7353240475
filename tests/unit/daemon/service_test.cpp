// The daemon as systemd sees it: what it tells on its notification socket, and reloading.
#include "unit/daemon/running_daemon.h"

namespace packmerger {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;

// The socket that systemd listens at.
class NotifySocket {
 public:
  explicit NotifySocket(const fs::path& path)
      : fd_(::socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::strcpy(address.sun_path, path.c_str());
    EXPECT_EQ(::bind(fd_, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
  }
  ~NotifySocket() { ::close(fd_); }

  // All that was told so far, one message each.
  const std::vector<std::string>& told() {
    std::array<char, 4096> block;
    for (ssize_t count; (count = ::recv(fd_, block.data(), block.size(), 0)) >= 0;)
      told_.emplace_back(block.data(), static_cast<std::size_t>(count));
    return told_;
  }
  std::size_t count(const std::string& message) {
    told();
    return static_cast<std::size_t>(std::count(told_.begin(), told_.end(), message));
  }

 private:
  int fd_;
  std::vector<std::string> told_;
};

class ServiceTest : public RunningDaemon {
 protected:
  void SetUp() override {
    RunningDaemon::SetUp();
    environment_ = {{"NOTIFY_SOCKET", path("notify").string()}, {"WATCHDOG_USEC", "2000000"}};
  }

  void add_printer(const std::string& name) {
    std::ofstream(path("d.toml"), std::ios::app)
        << "[printer." << name << "]\nprofile = \"objet30\"\nhandoff_folder = \"share\"\n";
  }

  void reload() { ::kill(daemon_->pid(), SIGHUP); }
  bool says(const std::string& text) {
    return wait_until([&] { return messages().find(text) != std::string::npos; });
  }

  std::vector<std::string> printers() {
    std::vector<std::string> names;
    for (const json& printer : ask({{"verb", "printers.list"}}))
      names.push_back(printer.at("name"));
    return names;
  }
};

TEST_F(ServiceTest, TellsWhatItDoes) {
  NotifySocket systemd(path("notify"));
  configure("/nonexistent/port");
  start();
  EXPECT_TRUE(wait_until([&] { return systemd.count("READY=1") == 1; }));
  EXPECT_TRUE(wait_until([&] { return systemd.count("STATUS=2 printers") == 1; }));
  drop("m", "slow.stl");
  EXPECT_TRUE(wait_until([&] { return systemd.count("STATUS=2 printers; preparing job 1") == 1; }));
  // four times in the watchdog's two seconds, though nothing happens
  const std::size_t before = systemd.count("WATCHDOG=1");
  EXPECT_TRUE(wait_until([&] { return systemd.count("WATCHDOG=1") >= before + 3; }));
  EXPECT_EQ(systemd.count("STOPPING=1"), 0U);
  EXPECT_EQ(end(SIGTERM).code, 0);
  EXPECT_EQ(systemd.count("STOPPING=1"), 1U);
}

TEST_F(ServiceTest, IsReadyOnlyAfterRecovery) {
  SimulatedMarlin marlin(1, path("record"));
  configure(marlin.port());
  NotifySocket systemd(path("notify"));
  start();
  drop("m", "long.stl");
  ASSERT_TRUE(reaches(1, "sending"));
  ASSERT_TRUE(wait_until([&] {  // what was not begun would wait
    const json progress = job(1).value("progress", json());
    return progress.is_object() && progress.value("stage", "connecting") != "connecting";
  }));
  end(SIGKILL);
  const std::size_t before = systemd.count("READY=1");
  start();
  ASSERT_TRUE(wait_until([&] { return systemd.count("READY=1") > before; }));
  EXPECT_EQ(job(1).at("state"), "failed");
  EXPECT_EQ(end(SIGTERM).code, 0);
}

TEST_F(ServiceTest, AMistakeInReloadedSettingsIsTold) {
  NotifySocket systemd(path("notify"));
  configure("/nonexistent/port");
  start();
  std::ofstream(path("d.toml"), std::ios::app) << "nonsense = 1\n";
  reload();
  EXPECT_TRUE(says("the settings stay as they were")) << messages();
  EXPECT_THAT(messages(), HasSubstr("unknown key printer.o.nonsense"));
  EXPECT_THAT(printers(), testing::ElementsAre("m", "o"));
  EXPECT_TRUE(wait_until([&] { return systemd.count("READY=1") == 2; }));
  EXPECT_THAT(systemd.told(), Contains(testing::StartsWith("RELOADING=1\nMONOTONIC_USEC=")));
  EXPECT_EQ(end(SIGTERM).code, 0);
}

TEST_F(ServiceTest, PrintersComeAndGoByReloading) {
  configure("/nonexistent/port");
  start();
  add_printer("later");
  reload();
  ASSERT_TRUE(wait_until([&] { return printers().size() == 3; })) << messages();
  ASSERT_TRUE(wait_until([&] { return fs::exists(path("state/folders/later")); }));
  drop("later", "dear.stl");
  ASSERT_TRUE(reaches(1, "ready"));
  configure("/nonexistent/port");
  reload();
  ASSERT_TRUE(wait_until([&] { return printers().size() == 2; }));
  ask({{"verb", "jobs.approve"}, {"id", 1}});
  EXPECT_EQ(job(1).at("waits_for"), "no_printer");
  add_printer("later");
  reload();
  ASSERT_TRUE(wait_until([&] { return printers().size() == 3; }));
  EXPECT_TRUE(reaches(1, "handed_over"));
  EXPECT_EQ(end(SIGTERM).code, 0);
}

TEST_F(ServiceTest, APrintGoesOnWhileItsPrinterIsChanged) {
  SimulatedMarlin first(1, path("record"));
  SimulatedMarlin second(0, path("record2"));
  configure(first.port());
  start();
  drop("m", "long.stl");
  ASSERT_TRUE(wait_until(
      [&] { return job(1)["progress"].is_object() && job(1)["progress"].value("done", 0) > 2; }));
  configure(second.port());
  add_printer("later");
  reload();
  ASSERT_TRUE(wait_until([&] { return printers().size() == 3; }));
  const json list = ask({{"verb", "printers.list"}});
  EXPECT_EQ(list.at(1).at("name"), "m");
  EXPECT_EQ(list.at(1).at("port"), first.port()) << "it prints";
  EXPECT_EQ(job(1).at("state"), "sending");
  ask({{"verb", "jobs.cancel"}, {"id", 1}});
  ASSERT_TRUE(reaches(1, "cancelled"));
  EXPECT_TRUE(says("printer m: settings taken over"));
  drop("m", "bunny.stl");
  EXPECT_TRUE(reaches(2, "done"));
  EXPECT_EQ(job(2).at("printer"), "m");
  EXPECT_THAT(without_comments(path("record2")), Not(testing::IsEmpty()));
  EXPECT_EQ(end(SIGTERM).code, 0);
}

}  // namespace
}  // namespace packmerger
