// The real daemon as a test runs it, with a stand-in for packmerger prepare, and a simulated
// printer.
#pragma once

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
#include "base/process/process.h"
#include "firmware_io/simulated/simulator.h"
#include "local/client.h"
#include "model/printer.h"

namespace packmerger {

using nlohmann::json;

inline constexpr int kPatience_s = 60;

inline bool wait_until(const std::function<bool()>& holds) {
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

class RunningDaemon : public testing::Test {
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

  void configure(const std::string& port, bool simulated = true, int workers = 1) {
    std::ofstream(path("d.toml"))
        << "state = \"state\"\nretry_s = 1\n[prepare]\nprogram = \""
        << (source_ / "tests/unit/daemon/fake_prepare.py").string()
        << "\"\nnice = 0\nworkers = " << workers << "\n[watch]\nstill_s = 0.2\ngive_up_s = 2\n"
        << "rescan_s = 1\n[printer.m]\nprofile = \"quick.toml\"\nport = \"" << port
        << "\"\napprove = \"auto\"\nsimulated = " << (simulated ? "true" : "false")
        << "\n[printer.o]\nprofile = \"objet30\"\nhandoff_folder = "
           "\"share\"\napprove = \"auto\"\nset = [\"cost.currency=EUR\"]\n";
  }

  void start() {
    ProcessSpec spec;
    spec.argv = {program_.string(), "--config", path("d.toml").string()};
    spec.set_env = environment_;
    spec.set_env["PACKMERGER_SOURCE"] = source_.string();
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
    fs::create_directories(target.parent_path());  // its folder worker does so too, a moment later
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

  std::map<std::string, std::string> environment_;  // of the daemon
  fs::path source_;
  fs::path program_;
  TemporaryFolder folder_;
  std::unique_ptr<ChildProcess> daemon_;
  std::string messages_;
};

}  // namespace packmerger
