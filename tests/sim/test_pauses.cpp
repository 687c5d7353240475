// Prints that somebody, or the machine itself, pauses, cancels or stops at once.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "firmware_io/simulated/marlin.h"
#include "firmware_io/simulated/replicator.h"
#include "sim/programs.h"
#include "sim/scenario.h"

namespace packmerger::test {
namespace {

using simulated::Marlin;
using simulated::MarlinTraits;
using simulated::Pace;
using simulated::Replicator;
using ::testing::HasSubstr;

constexpr double kPrinting_s = 90;  // both machines have heated and homed by then
constexpr double kLong_s = 7200;

// What the tests do and see while a print runs.
struct Play {
  double act_s = kPrinting_s;             // when act() is called,
  std::function<void()> act;              // once
  std::function<void()> go_on;            // kLong_s after that
  std::vector<PrintState> states;         // in order, each change once
  std::size_t executed_in_the_pause = 0;  // of the program, after the first second
  double ended_s = 0;
};

std::optional<Error> play(FaultyPort& port, bool gcode, const std::vector<std::string>& program,
                          const std::string& bytes, PrintControl& control, Play& play,
                          const StreamOptions& options = scenario_options()) {
  bool acted = false;
  bool going_on = false;
  std::optional<std::size_t> executed;
  port.on_step = [&](std::size_t) {
    if (port.now_s() > play.act_s && !std::exchange(acted, true)) play.act();
    if (port.now_s() > play.act_s + 10 && !executed && play.go_on)
      executed = only(port.executed(), program).size();
    if (port.now_s() > play.act_s + kLong_s && play.go_on && !std::exchange(going_on, true)) {
      play.executed_in_the_pause = only(port.executed(), program).size() - executed.value();
      play.go_on();
    }
  };
  const auto failure = print(
      port, gcode, bytes, control,
      [&](const PrintReport& report) {
        if (play.states.empty() || play.states.back() != report.state)
          play.states.push_back(report.state);
      },
      options);
  play.ended_s = port.now_s();
  return failure;
}

const std::vector<PrintState> kPausedOnce = {
    PrintState::kConnecting, PrintState::kPrinting, PrintState::kHeating, PrintState::kPrinting,
    PrintState::kPaused,     PrintState::kPrinting, PrintState::kDone};

constexpr std::size_t kMoves = 3000;

StreamOptions parking() {
  StreamOptions options = scenario_options();
  options.pause_gcode = "G91\nG1 Z7 F600 ; up\nG90\n";
  options.resume_gcode = "G91\nG1 Z-7 F600\nG90\n";
  return options;
}

// The lines from `first` on; empty where there is none.
std::vector<std::string> from(const std::vector<std::string>& lines, const std::string& first,
                              std::size_t length) {
  const auto begin = std::find(lines.begin(), lines.end(), first);
  const auto left = static_cast<std::size_t>(lines.end() - begin);
  return {begin, begin + static_cast<std::ptrdiff_t>(std::min(length, left))};
}

// A print on a simulated Marlin, and the day it has.
struct MarlinDay {
  explicit MarlinDay(MarlinTraits traits = {}) : firmware(Pace{1, false}, traits) {}
  std::optional<Error> print(const StreamOptions& options) {
    return play(port, true, program, joined(program), control, day, options);
  }

  Marlin firmware;
  FaultyPort port{firmware};
  PrintControl control;
  std::vector<std::string> program = gcode_program(kMoves);
  Play day;
};

class MarlinPause : public ::testing::Test, protected MarlinDay {};

struct ReplicatorDay {
  explicit ReplicatorDay(std::size_t moves = kMoves) : program(x3g_program(moves)) {}
  std::optional<Error> print() {
    return play(port, false, program.actions, program.bytes, control, day);
  }

  Replicator firmware{Pace{1, false}};
  FaultyPort port{firmware};
  PrintControl control;
  X3gProgram program;
  Play day;
};

class ReplicatorPause : public ::testing::Test, protected ReplicatorDay {};

void expect_marlin_pauses(MarlinTraits traits, std::size_t window_bytes) {
  MarlinDay scene(traits);
  auto& program = scene.program;
  program.insert(program.begin(), {"G90", "M83"});
  scene.day.act = [&] { scene.control.pause(); };
  scene.day.go_on = [&] { scene.control.resume(); };
  StreamOptions options = parking();
  options.window_bytes = window_bytes;
  const auto failure = scene.print(options);
  ASSERT_FALSE(failure) << failure->what();
  EXPECT_EQ(scene.day.states, kPausedOnce);
  EXPECT_EQ(scene.day.executed_in_the_pause, 0u);
  EXPECT_GT(scene.day.ended_s, kPrinting_s + kLong_s);
  // "G90" stands in program and texts alike, so both are looked at without it.
  std::vector<std::string> executed = scene.port.executed();
  for (auto* lines : {&executed, &program}) std::erase(*lines, "G90");
  std::erase(executed, "M105");
  EXPECT_EQ(from(executed, "M400", 3), (std::vector<std::string>{"M400", "G91", "G1 Z7 F600"}));
  EXPECT_EQ(from(executed, "G1 Z-7 F600", 3),
            (std::vector<std::string>{"G1 Z-7 F600", "M83", "G1 F6000"}));
  executed.erase(std::find(executed.begin(), executed.end(), "M83"));  // one of the two
  std::erase(program, "M83");
  EXPECT_EQ(only(executed, program), program);
}

TEST_F(MarlinPause, StandsStillForHoursAndGoesOn) { expect_marlin_pauses({}, 0); }

TEST_F(MarlinPause, WithoutReportsOfItsOwn) {
  MarlinTraits traits;
  traits.autoreport = false;
  expect_marlin_pauses(traits, 0);
}

TEST_F(MarlinPause, WithAWindow) { expect_marlin_pauses({}, 96); }

TEST_F(MarlinPause, CancelWhilePausedActsWithinASecond) {
  day.act = [&] { control.pause(); };
  day.go_on = [&] { control.cancel(); };
  const auto failure = print(parking());
  ASSERT_TRUE(failure);
  EXPECT_EQ(failure->fault(), Fault::kInterrupted);
  EXPECT_LT(day.ended_s, kPrinting_s + kLong_s + 1);
  EXPECT_EQ(count(port.executed(), "M140 S0"), 1u);
  EXPECT_EQ(count(port.executed(), "G1 Z-7 F600"), 0u) << "it does not go on";
}

MarlinTraits panel(bool blank) {
  MarlinTraits traits;
  traits.comment_blank = blank;
  return traits;
}

// "//action:pause" as Marlin writes it, "// action:pause" as Klipper and Prusa's firmware do.
class MarlinPanel : public ::testing::TestWithParam<bool>, protected MarlinDay {
 protected:
  MarlinPanel() : MarlinDay(panel(GetParam())) {}
};
INSTANTIATE_TEST_SUITE_P(Blank, MarlinPanel, ::testing::Bool());

TEST_P(MarlinPanel, AsksForAPause) {
  day.act = [&] { firmware.tell_host("pause"); };
  day.go_on = [&] { firmware.tell_host("resume"); };
  const auto failure = print(parking());
  ASSERT_FALSE(failure) << failure->what();
  EXPECT_EQ(day.states, kPausedOnce);
  EXPECT_EQ(day.executed_in_the_pause, 0u);
  EXPECT_EQ(count(port.executed(), "G1 Z7 F600"), 1u);
  EXPECT_EQ(only(port.executed(), program), program);
}

// It has parked by itself, so nothing of ours is executed; people may let it go on too.
TEST_P(MarlinPanel, SaysThatItStandsStillAlready) {
  const bool by_hand = !GetParam();
  day.act = [&] { firmware.tell_host("paused"); };
  day.go_on = [&] { by_hand ? control.resume() : firmware.tell_host("resumed"); };
  const auto failure = print(parking());
  ASSERT_FALSE(failure) << failure->what();
  EXPECT_EQ(day.states, kPausedOnce);
  EXPECT_EQ(day.executed_in_the_pause, 0u);
  EXPECT_EQ(count(port.executed(), "M400"), 1u) << "the one behind the program";
  EXPECT_EQ(count(port.executed(), "G1 Z7 F600"), 0u);
}

TEST_P(MarlinPanel, Cancels) {
  day.act = [&] { firmware.tell_host("cancel"); };
  const auto failure = print(scenario_options());
  ASSERT_TRUE(failure);
  EXPECT_EQ(failure->fault(), Fault::kIo);
  EXPECT_THAT(failure->what(), HasSubstr("cancelled at the printer"));
  EXPECT_LT(day.ended_s, kPrinting_s + 1);
  EXPECT_EQ(count(port.executed(), "M140 S0"), 1u) << "its heaters are turned off";
}

// While it heats, and while it stands paused.
TEST_F(MarlinPause, StopAtOnceHaltsAndNothingFollows) {
  for (const double act_s : {5.0, kPrinting_s}) {
    MarlinDay scene;
    scene.day.act_s = act_s;
    if (act_s > 5) {
      scene.day.act = [&] { scene.control.pause(); };
      scene.day.go_on = [&] { scene.control.stop_at_once(); };
    } else {
      scene.day.act = [&] { scene.control.stop_at_once(); };
    }
    const auto failure = scene.print(scenario_options());
    ASSERT_TRUE(failure);
    EXPECT_EQ(failure->fault(), Fault::kIo);
    EXPECT_THAT(failure->what(), HasSubstr("stopped at once"));
    EXPECT_LT(scene.day.ended_s, act_s + (scene.day.go_on ? kLong_s : 0) + 1);
    EXPECT_THAT(scene.port.sent, ::testing::EndsWith("M112\n"));
    scene.firmware.advance(scene.day.ended_s);
    EXPECT_EQ(scene.port.executed().back(), "halt");
  }
}

TEST_F(ReplicatorPause, StandsStillForHoursAndGoesOn) {
  day.act = [&] { control.pause(); };
  day.go_on = [&] { control.resume(); };
  const auto failure = print();
  ASSERT_FALSE(failure) << failure->what();
  EXPECT_EQ(day.states, kPausedOnce);
  EXPECT_EQ(day.executed_in_the_pause, 0u);
  EXPECT_EQ(port.executed(), program.actions);
}

// We neither undo it nor lose patience, though the whole program may be in the printer already.
TEST_F(ReplicatorPause, AtItsPanel) {
  for (const std::size_t moves : {kMoves, std::size_t{5}}) {
    ReplicatorDay scene(moves);
    if (moves < kMoves) scene.day.act_s = 20;
    scene.day.act = [&] { scene.firmware.press_pause(); };
    scene.day.go_on = [&] { scene.firmware.press_pause(); };
    const auto failure = scene.print();
    ASSERT_FALSE(failure) << failure->what();
    EXPECT_EQ(std::count(scene.day.states.begin(), scene.day.states.end(), PrintState::kPaused), 1);
    EXPECT_EQ(scene.day.executed_in_the_pause, 0u);
    EXPECT_EQ(scene.port.executed(), scene.program.actions);
  }
}

// Asking for what is so already must not toggle it.
TEST_F(ReplicatorPause, PausedTwiceIsPaused) {
  day.act = [&] {
    firmware.press_pause();
    control.pause();
  };
  day.go_on = [&] { control.resume(); };
  const auto failure = print();
  ASSERT_FALSE(failure) << failure->what();
  EXPECT_EQ(day.executed_in_the_pause, 0u);
  EXPECT_EQ(port.executed(), program.actions);
}

TEST_F(ReplicatorPause, CancelWhilePausedActsWithinASecond) {
  day.act = [&] { control.pause(); };
  day.go_on = [&] { control.cancel(); };
  const auto failure = print();
  ASSERT_TRUE(failure);
  EXPECT_EQ(failure->fault(), Fault::kInterrupted);
  EXPECT_LT(day.ended_s, kPrinting_s + kLong_s + 1);
  EXPECT_EQ(port.executed().back(), "abort");
}

TEST_F(ReplicatorPause, StopAtOnceAborts) {
  day.act = [&] { control.stop_at_once(); };
  const auto failure = print();
  ASSERT_TRUE(failure);
  EXPECT_EQ(failure->fault(), Fault::kIo);
  EXPECT_THAT(failure->what(), HasSubstr("stopped at once"));
  EXPECT_LT(day.ended_s, kPrinting_s + 1);
  firmware.advance(day.ended_s + 1);
  EXPECT_EQ(port.executed().back(), "abort");
}

}  // namespace
}  // namespace packmerger::test
