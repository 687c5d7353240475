// What Replicators do in the middle of a print, each trap that real firmware was seen to set, in
// simulated time; and links that meet the wrong machine, or none.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "firmware_io/simulated/marlin.h"
#include "firmware_io/simulated/replicator.h"
#include "sim/programs.h"
#include "sim/scenario.h"

namespace packmerger::test {
namespace {

using simulated::Marlin;
using simulated::Pace;
using simulated::Replicator;
using ::testing::HasSubstr;

TEST(Links, NobodyThere) {
  for (const bool gcode : {true, false}) {
    Parrot firmware([](const std::string&) { return std::string(); });
    FaultyPort port(firmware);
    PrintControl control;
    const auto failure = print(port, gcode, gcode ? "G28\n" : x3g_program(2).bytes, control);
    ASSERT_TRUE(failure);
    EXPECT_EQ(failure->fault(), Fault::kUnavailable);
  }
}

TEST(Links, TheOtherProtocolIsTheWrongPrinter) {
  Marlin marlin(Pace{1, true});
  FaultyPort marlin_port(marlin);
  PrintControl control;
  const auto x3g_failure = print(marlin_port, false, x3g_program(2).bytes, control);
  ASSERT_TRUE(x3g_failure);
  EXPECT_EQ(x3g_failure->fault(), Fault::kUnavailable);

  Replicator replicator(Pace{1, true});
  FaultyPort replicator_port(replicator);
  const auto gcode_failure = print(replicator_port, true, "G28\n", control);
  ASSERT_TRUE(gcode_failure);
  EXPECT_EQ(gcode_failure->fault(), Fault::kUnavailable);
  EXPECT_TRUE(replicator_port.executed().empty());
}

TEST(Replicator, FullBufferIsWaitedOut) {
  Replicator firmware(Pace{1, false});
  FaultyPort port(firmware);
  PrintControl control;
  const X3gProgram program = x3g_program(100);
  bool heated = false;
  const auto failure = print(port, false, program.bytes, control, [&](const PrintReport& report) {
    heated = heated || report.state == PrintState::kHeating;
  });
  EXPECT_FALSE(failure) << failure->what();
  EXPECT_EQ(port.executed(), program.actions);
  EXPECT_TRUE(heated);
  EXPECT_GT(port.now_s(), 60) << "it has to heat up";
}

TEST(Replicator, StartAndEndAreAdded) {
  Replicator firmware(Pace{1, true});
  FaultyPort port(firmware);
  PrintControl control;
  const auto failure = print(port, false, std::string("\x97\x01\x86\0", 4), control);
  EXPECT_FALSE(failure) << failure->what();
  const std::vector<std::string> expected = {"99000000007363656e6172696f00", "9701", "8600",
                                             "9a00"};
  EXPECT_EQ(port.executed(), expected);
}

void expect_cause(const std::function<void(Replicator&)>& event, const std::string& cause) {
  Replicator firmware(Pace{1, false});
  FaultyPort port(firmware);
  bool done = false;
  port.on_step = [&](std::size_t) {
    if (port.now_s() > 20 && !std::exchange(done, true)) event(firmware);
  };
  PrintControl control;
  const auto failure = print(port, false, x3g_program(100).bytes, control);
  ASSERT_TRUE(failure);
  EXPECT_EQ(failure->fault(), Fault::kIo);
  EXPECT_THAT(failure->what(), HasSubstr(cause));
  EXPECT_LT(port.now_s(), 25);
}

TEST(Replicator, CancelledAtItsPanel) {
  expect_cause([](Replicator& machine) { machine.cancel_at_panel(); }, "cancelled at the printer");
}

TEST(Replicator, Overheated) {
  expect_cause([](Replicator& machine) { machine.overheat(); }, "shut its heaters down");
}

TEST(Replicator, PowerCut) {
  expect_cause([](Replicator& machine) { machine.power_cycle(); }, "reset");
}

// Before its build was ever seen running, the state "no build" could be the old one.
TEST(Replicator, PowerCutInTheFirstSecond) {
  Replicator firmware(Pace{1, false});
  FaultyPort port(firmware);
  bool done = false;
  port.on_step = [&](std::size_t) {
    if (port.now_s() > 0.2 && !std::exchange(done, true)) firmware.power_cycle();
  };
  PrintControl control;
  const X3gProgram program = x3g_program(100);
  const auto failure = print(port, false, program.bytes, control);
  ASSERT_TRUE(failure);
  EXPECT_THAT(failure->what(), HasSubstr("reset"));
  const auto executed = port.executed();
  ASSERT_LT(executed.size(), program.actions.size());
  EXPECT_TRUE(std::equal(executed.begin(), executed.end(), program.actions.begin()));
}

TEST(Replicator, CancelWhileHeatingActsWithinASecond) {
  Replicator firmware(Pace{1, false});
  FaultyPort port(firmware);
  PrintControl control;
  double asked_at_s = 0;
  port.on_step = [&](std::size_t) {
    if (asked_at_s == 0 && port.now_s() > 20) {
      asked_at_s = port.now_s();
      control.cancel();
    }
  };
  const auto failure = print(port, false, x3g_program(100).bytes, control);
  ASSERT_TRUE(failure);
  EXPECT_EQ(failure->fault(), Fault::kInterrupted);
  EXPECT_LT(port.now_s() - asked_at_s, 1);
  EXPECT_EQ(port.executed().back(), "abort");
}

// How a print ends that is heating when the machine falls silent (it hears nothing either) and,
// a little later, somebody wants to end it.
std::optional<Error> end_silent_machine(FaultyPort& port, PrintControl& control,
                                        const std::function<void()>& wish, double wish_s = 20.5) {
  port.on_send = [&](std::string& bytes) {
    if (port.now_s() > 20) bytes.clear();
  };
  port.on_step = [&, wish_s, wished = false](std::size_t) mutable {
    if (port.now_s() > wish_s && !std::exchange(wished, true)) wish();
  };
  return print(port, false, x3g_program(100).bytes, control);
}

TEST(SilentReplicator, ACancelIsTheCauseThatIsTold) {
  // before and while a question of the link's own is not answered
  for (const double wish_s : {20.05, 20.5, 23.0}) {
    Replicator firmware(Pace{1, false});
    FaultyPort port(firmware);
    PrintControl control;
    const auto failure = end_silent_machine(
        port, control, [&] { control.cancel(); }, wish_s);
    ASSERT_TRUE(failure) << wish_s;
    EXPECT_EQ(failure->fault(), Fault::kInterrupted);
    EXPECT_THAT(failure->what(), HasSubstr("The print was cancelled, but"));
    EXPECT_THAT(failure->hint(), HasSubstr("heaters may be on"));
  }
}

TEST(SilentReplicator, AStopAtOnceIsTheCauseThatIsTold) {
  Replicator firmware(Pace{1, false});
  FaultyPort port(firmware);
  PrintControl control;
  const auto failure = end_silent_machine(port, control, [&] { control.stop_at_once(); });
  ASSERT_TRUE(failure);
  EXPECT_EQ(failure->fault(), Fault::kIo);
  EXPECT_THAT(failure->what(), HasSubstr("stopped at once, as somebody asked, but"));
  EXPECT_THAT(failure->hint(), HasSubstr("heaters may be on"));
}

const std::string kAbortPacket("\xD5\x01\x07\x83", 4);

// Nor does anybody wait for a cancel that is under way already.
TEST(SilentReplicator, WhoLeavesWaitsForNothing) {
  for (const bool cancelled : {false, true}) {
    Replicator firmware(Pace{1, false});
    FaultyPort port(firmware);
    PrintControl control;
    const auto failure = end_silent_machine(port, control, [&] {
      if (cancelled) control.cancel();
      control.leave();
    });
    ASSERT_TRUE(failure);
    EXPECT_EQ(failure->fault(), Fault::kInterrupted);
    EXPECT_THAT(failure->what(), HasSubstr("ended at once"));
    EXPECT_THAT(failure->hint(), HasSubstr("heaters may be on"));
    EXPECT_THAT(port.sent, ::testing::EndsWith(kAbortPacket));
    EXPECT_LT(port.now_s(), 22);
  }
}

TEST(Replicator, WhoLeavesHasTheHeatersTurnedOff) {
  Replicator firmware(Pace{1, false});
  FaultyPort port(firmware);
  PrintControl control;
  port.on_step = [&](std::size_t) {
    if (port.now_s() > 20) control.leave();
  };
  const auto failure = print(port, false, x3g_program(100).bytes, control);
  ASSERT_TRUE(failure);
  EXPECT_EQ(failure->fault(), Fault::kInterrupted);
  EXPECT_THAT(failure->what(), HasSubstr("ended at once"));
  EXPECT_LT(port.now_s(), 20.5);
  port.leave_alone(5);
  EXPECT_EQ(port.executed().back(), "abort");
}

// One that goes on building whatever it is told.
TEST(Replicator, ThatDoesNotObeyACancelMayBeHot) {
  Replicator firmware(Pace{1, false});
  FaultyPort port(firmware);
  PrintControl control;
  port.on_send = [&](std::string& bytes) {
    if (bytes == kAbortPacket) bytes = std::string("\xD5\x01\x01\x5E", 4);  // init
  };
  port.on_step = [&](std::size_t) {
    if (port.now_s() > 20) control.cancel();
  };
  const auto failure = print(port, false, x3g_program(100).bytes, control);
  ASSERT_TRUE(failure);
  EXPECT_EQ(failure->fault(), Fault::kInterrupted);
  EXPECT_THAT(failure->what(), HasSubstr("told to cancel but is still building"));
  EXPECT_THAT(failure->hint(), HasSubstr("heaters may be on"));
}

TEST(Replicator, ABuildOfSomeoneElseIsNotTouched) {
  Replicator firmware(Pace{1, true});
  firmware.receive(std::string("\xD5\x07\x99\0\0\0\0\x61\0\x3E", 10), 0);  // build start "a"
  firmware.take_output();
  FaultyPort port(firmware);
  PrintControl control;
  const auto failure = print(port, false, x3g_program(3).bytes, control);
  ASSERT_TRUE(failure);
  EXPECT_EQ(failure->fault(), Fault::kBusy);
  EXPECT_EQ(port.executed(), std::vector<std::string>{"99000000006100"});
}

}  // namespace
}  // namespace packmerger::test
