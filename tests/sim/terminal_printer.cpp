#include "sim/terminal_printer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <future>

#include "firmware_io/gcode/gcode_link.h"
#include "firmware_io/s3g/s3g_link.h"
#include "sim/programs.h"

namespace packmerger::test {

namespace {

StreamOptions options() {
  StreamOptions options;
  options.boot_wait_s = 0.05;
  options.safe_gcode = "M104 S0\nM140 S0\n";
  return options;
}

}  // namespace

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

Printer::Printer(Machine machine, double speed) {
  options_.speed = speed;
  options_.record = folder_.path() / "record.txt";
  std::promise<std::string> path;
  auto ready = path.get_future();
  thread_ = std::thread([this, machine, promise = std::move(path)]() mutable {
    const auto listening = [&](const std::string& at) { promise.set_value(at); };
    if (machine == Machine::kReplicator)
      run_simulated_replicator(options_, {}, listening, stop_);
    else
      run_simulated_marlin(options_, {}, listening, stop_);
  });
  path_ = ready.get();
}

void Printer::unplug() {
  stop_ = true;
  if (thread_.joinable()) thread_.join();
}

std::vector<std::string> Printer::record() const {
  std::ifstream file(options_.record);
  std::vector<std::string> lines;
  for (std::string line; std::getline(file, line);) lines.push_back(line);
  return lines;
}

std::optional<Error> print(Machine machine, const std::string& address, const std::string& program,
                           PrintControl& control) {
  try {
    const auto port = open_port(address, 115200);
    if (machine == Machine::kReplicator)
      print_x3g(*port, program, options(), {}, control);
    else
      print_gcode(*port, program, options(), {}, control);
  } catch (const Error& error) {
    return error;
  }
  return std::nullopt;
}

void expect_failure_soon(Machine machine, const std::string& address,
                         const std::function<void()>& lose_the_printer) {
  PrintControl control;
  auto done = std::async(std::launch::async, [&] {
    return print(machine, address, program_of(machine, 2000), control);
  });
  std::this_thread::sleep_for(std::chrono::milliseconds(700));
  const auto begin = Clock::now();
  lose_the_printer();
  const auto failure = done.get();
  EXPECT_LT(seconds_since(begin), 5);
  ASSERT_TRUE(failure);
  EXPECT_EQ(failure->fault(), Fault::kIo);
  EXPECT_THAT(failure->what(), ::testing::HasSubstr("is gone"));
}

std::string program_of(Machine machine, std::size_t moves) {
  return machine == Machine::kReplicator ? x3g_program(moves).bytes : joined(gcode_program(moves));
}

std::vector<std::string> executed_by_marlin(std::size_t commands) {
  std::vector<std::string> lines = {"M115", "M27", "M110 N0", "M155 S2"};
  for (const std::string& line : gcode_program(commands)) lines.push_back(line);
  lines.insert(lines.end(), {"M400", "M114", "M155 S0"});
  return lines;
}

std::vector<std::string> without_questions(std::vector<std::string> record) {
  std::erase(record, "M105");
  return record;
}

}  // namespace packmerger::test
