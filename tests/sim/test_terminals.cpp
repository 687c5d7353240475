// Whole prints over real pseudo-terminals: the links on one side, a simulated printer on the other.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <future>

#include "base/process/process.h"
#include "firmware_io/ports/port.h"
#include "sim/programs.h"
#include "sim/terminal_printer.h"

namespace packmerger::test {
namespace {

TEST(Terminals, ReplicatorExecutesTheProgram) {
  Printer printer(Machine::kReplicator, 0);
  PrintControl control;
  const auto failure =
      print(Machine::kReplicator, printer.path(), program_of(Machine::kReplicator, 5000), control);
  EXPECT_FALSE(failure) << failure->what();
  EXPECT_EQ(printer.record(), x3g_program(5000).actions);
}

TEST(Terminals, MarlinExecutesTheProgram) {
  Printer printer(Machine::kMarlin, 0);
  PrintControl control;
  const auto failure =
      print(Machine::kMarlin, printer.path(), program_of(Machine::kMarlin, 5000), control);
  EXPECT_FALSE(failure) << failure->what();
  EXPECT_EQ(without_questions(printer.record()), executed_by_marlin(5000));
}

TEST(Terminals, PrintsOneJobAfterTheOther) {
  Printer printer(Machine::kReplicator, 0);
  PrintControl control;
  for (int i = 0; i < 3; ++i)
    EXPECT_FALSE(print(Machine::kReplicator, printer.path(), x3g_program(5).bytes, control));
}

TEST(Terminals, SecondOpenerIsRefused) {
  Printer printer(Machine::kMarlin, 0);
  const fs::path link = printer.folder() / "printer";
  fs::create_symlink(printer.path(), link);
  const auto port = open_port(link.string(), 115200);
  try {
    open_port(printer.path(), 115200);
    FAIL() << "was opened twice";
  } catch (const Error& error) {
    EXPECT_EQ(error.fault(), Fault::kBusy);
  }
}

TEST(Terminals, WhatIsNoPort) {
  for (const char* address : {"/dev/no-such-printer", "/dev/null", "/etc/hostname", "/tmp"}) {
    try {
      open_port(address, 115200);
      FAIL() << address;
    } catch (const Error& error) {
      EXPECT_EQ(error.fault(), Fault::kUnavailable) << address;
      EXPECT_FALSE(error.hint().empty());
    }
  }
}

class EachMachine : public ::testing::TestWithParam<Machine> {};

TEST_P(EachMachine, UnpluggedPrinterFailsSoon) {
  Printer printer(GetParam(), 10);
  expect_failure_soon(GetParam(), printer.path(), [&] { printer.unplug(); });
}

// From another thread, while the machine heats.
TEST_P(EachMachine, CancelActsWithinASecond) {
  Printer printer(GetParam(), 1);
  PrintControl control;
  auto done = std::async(std::launch::async, [&] {
    return print(GetParam(), printer.path(), program_of(GetParam(), 2000), control);
  });
  std::this_thread::sleep_for(std::chrono::milliseconds(1500));
  const auto begin = Clock::now();
  control.cancel();
  const auto failure = done.get();
  EXPECT_LT(seconds_since(begin), 1.5) << "a second, and some for a busy machine";
  ASSERT_TRUE(failure);
  EXPECT_EQ(failure->fault(), Fault::kInterrupted) << failure->what();
}

INSTANTIATE_TEST_SUITE_P(Both, EachMachine,
                         ::testing::Values(Machine::kReplicator, Machine::kMarlin));

// A client that nobody here wrote.
TEST(Terminals, GpxPrintsToTheReplicator) {
  Printer printer(Machine::kReplicator, 0);
  const fs::path gcode = printer.folder() / "job.gcode";
  write_file_whole(gcode,
                   "G21\nG90\nG162 X Y F2500\nG161 Z F1100\nG92 X0 Y0 Z0 A0 B0\n"
                   "G1 X10 Y10 Z0.2 F3000\nG1 X20 Y10 E1 F1800\nG4 P100\nM18\n");
  const std::vector<std::string> common = {"gpx", "-I", "-m", "r1d"};
  std::vector<std::string> stream = common;
  stream.insert(stream.end(), {"-s", "-W", "0", gcode.string(), printer.path()});
  std::vector<std::string> convert = common;
  const fs::path x3g = printer.folder() / "job.x3g";
  convert.insert(convert.end(), {gcode.string(), x3g.string()});
  for (const auto& argv : {stream, convert}) {
    ProcessSpec spec;
    spec.argv = argv;
    ASSERT_TRUE(run_process(spec, 30, {}).status.ok());
  }

  std::string streamed;
  for (const std::string& line : printer.record()) streamed += line;
  const std::string converted = hex(read_file(x3g, 1 << 20));
  ASSERT_FALSE(converted.empty());
  // The two name the build after their outputs; behind that they are the same.
  const std::string home = "8403";
  ASSERT_NE(streamed.find(home), std::string::npos) << streamed;
  EXPECT_EQ(streamed.substr(streamed.find(home)), converted.substr(converted.find(home)));
}

}  // namespace
}  // namespace packmerger::test
