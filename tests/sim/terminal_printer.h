// Whole prints at a simulated printer in real time.
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "base/error.h"
#include "base/files.h"
#include "firmware_io/print_state.h"
#include "firmware_io/simulated/simulator.h"

namespace packmerger::test {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin);

enum class Machine { kReplicator, kMarlin };

// A simulated printer on a thread of its own; ends with the object, or before by unplug().
class Printer {
 public:
  Printer(Machine machine, double speed);
  Printer(const Printer&) = delete;
  Printer& operator=(const Printer&) = delete;
  ~Printer() { unplug(); }

  void unplug();

  const std::string& path() const { return path_; }
  const fs::path& folder() const { return folder_.path(); }
  std::vector<std::string> record() const;

 private:
  TemporaryFolder folder_;
  SimulatorOptions options_;
  std::atomic<bool> stop_{false};
  std::string path_;
  std::thread thread_;
};

// What ended the print before its end.
std::optional<Error> print(Machine machine, const std::string& address, const std::string& program,
                           PrintControl& control);

// A print at a machine that works ten times as fast, while which the printer is lost: it must fail
// within five seconds, saying so.
void expect_failure_soon(Machine machine, const std::string& address,
                         const std::function<void()>& lose_the_printer);

std::string program_of(Machine machine, std::size_t moves);

// What the simulated Marlin records of a print of gcode_program(commands).
std::vector<std::string> executed_by_marlin(std::size_t commands);
// A record without the M105 by which the link asks now and then where the printer is.
std::vector<std::string> without_questions(std::vector<std::string> record);

}  // namespace packmerger::test
