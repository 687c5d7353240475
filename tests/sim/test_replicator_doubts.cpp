// Whether a Replicator took a command whose answer got lost, where, as usual, it counts nothing:
// its buffer and its position tell, or the print fails.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "firmware_io/s3g/s3g.h"
#include "firmware_io/s3g/s3g_axes.h"
#include "firmware_io/s3g/s3g_buffer.h"
#include "firmware_io/simulated/replicator.h"
#include "sim/programs.h"
#include "sim/scenario.h"

namespace packmerger::test {
namespace {

using simulated::Pace;
using simulated::Replicator;
using ::testing::HasSubstr;

constexpr std::size_t kMoves = 40;

TEST(Buffer, TellsWhereOnlyOneOfTwoLeavesSoMuch) {
  s3g::Buffer buffer;
  EXPECT_FALSE(buffer.tells(480, 32)) << "never seen empty";
  buffer.emptied(512);
  for (const std::size_t length : {32, 32, 3, 32}) buffer.add(length);
  EXPECT_EQ(buffer.tells(512 - 99 - 32, 32), true) << "fuller than it was";
  EXPECT_EQ(buffer.tells(512 - 99, 32), std::nullopt) << "or a move less and one more";
  EXPECT_EQ(buffer.tells(512 - 35, 32), false);
  EXPECT_EQ(buffer.tells(512 - 64, 32), true);
  EXPECT_EQ(buffer.tells(512 - 38, 3), true);
  EXPECT_EQ(buffer.tells(512, 32), std::nullopt) << "empty in any case";
  EXPECT_EQ(buffer.tells(512 - 41, 32), std::nullopt) << "neither";
  buffer.observe(512 - 32);
  EXPECT_EQ(buffer.tells(512 - 64, 32), true) << "for the others were gone";
}

TEST(Buffer, CountsWhatIsInIt) {
  s3g::Buffer buffer;
  EXPECT_FALSE(buffer.actions(512));
  buffer.emptied(512);
  for (const std::size_t length : {32, 3, 32}) buffer.add(length);
  EXPECT_EQ(buffer.actions(512 - 67), 3U);
  EXPECT_EQ(buffer.actions(512 - 35), 2U);
  EXPECT_EQ(buffer.actions(512), 0U);
  EXPECT_EQ(buffer.actions(500), std::nullopt);
}

TEST(Buffer, TellsNothingOnceItHeldWhatNobodyGave) {
  s3g::Buffer buffer;
  buffer.emptied(512);
  buffer.add(32);
  buffer.observe(512 - 40);
  EXPECT_FALSE(buffer.tells(512 - 32, 3));
  buffer.emptied(600);
  EXPECT_EQ(buffer.tells(600 - 3, 3), true);
}

TEST(Axes, ShowASetPositionWithTheNextMove) {
  s3g::Axes axes;
  const std::string set = "\x8C" + std::string(20, '\0');
  const std::string home = "\x83\x01" + std::string(6, '\0');
  std::string move = "\x9B" + std::string(20, '\1') + std::string(4, '\0') + '\x18';
  const std::string no_way = move + std::string(6, '\0');
  move += std::string(6, '\1');
  axes.apply(set);
  EXPECT_FALSE(axes.shown(0));
  axes.apply(no_way);
  EXPECT_FALSE(axes.shown(0)) << "passed over";
  axes.apply(move);
  axes.apply(move);
  EXPECT_EQ(axes.shown(0), 0x01010101);
  EXPECT_EQ(axes.shown(3), 0x02020202) << "relative";
  axes.apply(home);
  EXPECT_FALSE(axes.shown(0));
  EXPECT_TRUE(axes.shown(1));
}

TEST(Axes, AMachineAtRestTellsWhatItHasExecuted) {
  const std::string move = "\x8B" + std::string(24, '\0');
  std::string next = move;
  next[1] = 5;
  s3g::Axes without;
  without.apply(move);
  s3g::Axes with = without;
  with.apply(next);
  EXPECT_EQ(tells({0, 7, 0, 0, 0}, without, with), false) << "of the other axes nothing is asked";
  EXPECT_EQ(tells({5, 0, 0, 0, 0}, without, with), true);
  EXPECT_EQ(tells({4, 0, 0, 0, 0}, without, with), std::nullopt);
  EXPECT_EQ(tells({0, 0, 0, 0, 0}, without, without), std::nullopt);
}

bool is_move(const std::string& bytes) { return bytes.size() == 35 && bytes[2] == '\x9B'; }

// A print in which something happens to one move, on a machine that is quick or takes its time.
class Doubt : public ::testing::TestWithParam<bool> {
 protected:
  void expect_through() {
    PrintControl control;
    const auto failure = print(port_, false, program_.bytes, control);
    EXPECT_FALSE(failure) << failure->what();
    EXPECT_EQ(port_.executed(), program_.actions);
  }

  // Called with the packet of the `at`th move that is sent.
  void at_move(int at, std::function<void(std::string& bytes)> act) {
    port_.on_send = [this, at, act = std::move(act), seen = 0](std::string& bytes) mutable {
      port_.lose_answers = false;
      if (is_move(bytes) && ++seen == at) act(bytes);
    };
  }

  X3gProgram program_ = x3g_program(kMoves);
  Replicator machine_{Pace{1, GetParam()}};
  FaultyPort port_{machine_};
};

TEST_P(Doubt, ALostAnswerIsMadeUpFor) {
  at_move(30, [this](std::string&) { port_.lose_answers = true; });
  expect_through();
}

TEST_P(Doubt, ALostMoveIsSentAgain) {
  at_move(30, [](std::string& bytes) { bytes.clear(); });
  expect_through();
}

TEST_P(Doubt, ALengthThatWasDamagedIsSentAgain) {
  at_move(30, [](std::string& bytes) { bytes[1] = static_cast<char>(bytes[1] | 0x40); });
  expect_through();
  EXPECT_EQ(count(port_.executed(), program_.actions.back()), 1U);
}

TEST_P(Doubt, ACancelWhoseOnlyAnswerIsLostIsNoticed) {
  at_move(30, [this](std::string&) {
    machine_.cancel_at_panel();
    port_.lose_answers = true;
  });
  PrintControl control;
  const auto failure = print(port_, false, program_.bytes, control);
  ASSERT_TRUE(failure);
  EXPECT_STREQ(failure->what(), "The build was cancelled at the printer");
}

// Commands were given to the printer before, so that its buffer is not empty when the link begins.
TEST_P(Doubt, ABufferThatHeldSomethingAtFirst) {
  const std::string delay = s3g::packet(std::string("\x85\x88\x13\0\0", 5));
  machine_.receive(delay + delay, 0);
  machine_.take_output();
  at_move(30, [this](std::string&) { port_.lose_answers = true; });
  PrintControl control;
  const auto failure = print(port_, false, program_.bytes, control);
  EXPECT_FALSE(failure) << failure->what();
  const auto& executed = port_.executed();
  EXPECT_EQ(std::vector<std::string>(executed.begin() + 2, executed.end()), program_.actions);
}

INSTANTIATE_TEST_SUITE_P(Replicator, Doubt, ::testing::Values(true, false),
                         [](const auto& quick) { return quick.param ? "Quick" : "Slow"; });

// Nothing of a song is seen, and where it has left the buffer it cannot be asked for, unless the
// firmware was built to count.
TEST(Replicator, WhatNothingTellsOfEndsThePrint) {
  const std::string song("\x97\x01", 2);
  for (const bool counts : {false, true}) {
    simulated::ReplicatorTraits traits;
    traits.counts_actions = counts;
    Replicator machine(Pace{1, true}, traits);
    FaultyPort port(machine);
    port.on_send = [&, lost = false](std::string& bytes) mutable {
      port.lose_answers = bytes == s3g::packet(song) && !std::exchange(lost, true);
    };
    PrintControl control;
    const auto failure = print(port, false, song + song, control);
    const std::string cause = failure ? failure->what() : "";
    EXPECT_EQ(cause.empty(), counts);
    EXPECT_THAT(cause, counts ? HasSubstr("") : HasSubstr("nothing tells whether it took"));
    EXPECT_EQ(count(port.executed(), "9701"), counts ? 2U : 1U);
  }
}

}  // namespace
}  // namespace packmerger::test
