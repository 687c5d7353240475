// The traps of Sailfish as docs/PROTOCOLS lists them: that the simulated one sets them as the true
// one did, and that a print gets through each alone.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <optional>

#include "base/error.h"
#include "firmware_io/s3g/s3g.h"
#include "firmware_io/simulated/replicator.h"
#include "sim/programs.h"
#include "sim/scenario.h"
#include "sim/wire.h"

namespace packmerger::test {
namespace {

using simulated::Pace;
using simulated::Replicator;
using simulated::ReplicatorTraits;
using ::testing::HasSubstr;

constexpr Pace kRealTime{1, false};

ReplicatorTraits with(std::string_view change) {
  ReplicatorTraits traits;
  EXPECT_TRUE(set_trait(traits, change)) << change;
  return traits;
}

std::string bytes(std::string_view payload) { return s3g::packet(payload); }
const std::string kVersionQuery("\0\x64\0", 3);
const std::string kStatistics("\x18", 1);
const std::string kMove = "\x9B" + std::string(31, '\0');

class ReplicatorTraps : public ::testing::Test {
 protected:
  std::string says(const std::string& sent, double seconds = 0.01) {
    return hex(wire_.says(sent, seconds));
  }
  Replicator machine_{kRealTime};
  Wire wire_{machine_};
};

TEST_F(ReplicatorTraps, VersionIsHiddenFromOldHosts) {
  EXPECT_EQ(says(bytes(kVersionQuery)), "d50381c402fa");
  EXPECT_EQ(says(bytes(std::string("\0\x26\0", 3))), hex(bytes(std::string("\x81\0\0", 3))));
  Replicator open(kRealTime, with("version_hidden=off"));
  EXPECT_EQ(hex(Wire(open).says(bytes(std::string("\0\x26\0", 3)))), "d50381c402fa");
}

TEST_F(ReplicatorTraps, AStrayByteIsComplainedAboutUntilAPacketComes) {
  EXPECT_GT(says(std::string(1, '\0'), 0.05).size(), 50 * std::string("d501808c").size());
  EXPECT_GT(says("", 0.05).size(), 50 * std::string("d501808c").size());
  EXPECT_EQ(says(bytes(kVersionQuery)), "d50381c402fa");
  EXPECT_EQ(says("", 1), "");
  Replicator calm(kRealTime, with("noise_endless=off"));
  EXPECT_EQ(hex(Wire(calm).says(std::string(1, '\0'), 1)), "d501808c");
}

TEST_F(ReplicatorTraps, AFullBufferDropsThePacketWhole) {
  says(bytes(std::string("\x85\x10\x27\0\0", 5)) + bytes(std::string("\x85\x10\x27\0\0", 5)));
  std::string said;
  for (int i = 0; i < 15; ++i) EXPECT_EQ(says(bytes(kMove)), hex(bytes("\x81")));
  EXPECT_EQ(says(bytes(kMove)), hex(bytes("\x82")));
  EXPECT_EQ(says(bytes("\x02")), hex(bytes(std::string("\x81\x1B\0\0\0", 5)))) << "27 bytes free";
}

TEST_F(ReplicatorTraps, ABadChecksum) {
  std::string bad = bytes(kVersionQuery);
  bad.back() = '\x60';
  EXPECT_EQ(says(bad), "d501836e");
}

TEST_F(ReplicatorTraps, TooLongAPayload) { EXPECT_EQ(says("\xD5\x21"), "d50184ed"); }

TEST_F(ReplicatorTraps, AnUnknownQuery) { EXPECT_EQ(says(bytes("\x7F")), "d50185b3"); }

TEST_F(ReplicatorTraps, ATruncatedPacketIsTimedOut) {
  EXPECT_EQ(says(bytes(kVersionQuery).substr(0, 3), 0.15), "");
  EXPECT_EQ(says("", 0.06), "d5018c2f");
  Replicator patient(kRealTime, with("packet_timeout=off"));
  Wire wire(patient);
  const std::string query = bytes(kVersionQuery);
  EXPECT_EQ(wire.says(query.substr(0, 3), 5), "");
  EXPECT_EQ(hex(wire.says(query.substr(3))), "d50381c402fa");
}

TEST_F(ReplicatorTraps, AnUnknownActionIsTakenAndLosesTheBuild) {
  says(bytes(s3g::build_start("a")));
  EXPECT_EQ(says(bytes("\xFF")), hex(bytes("\x81")));
  EXPECT_EQ(says(bytes(kStatistics)).substr(4, 4), "8100") << "no build";
  Replicator strict(kRealTime, with("unknown_accepted=off"));
  EXPECT_EQ(hex(Wire(strict).says(bytes("\xFF"))), "d50185b3");
}

TEST_F(ReplicatorTraps, CancelledAtThePanelIsToldOnce) {
  machine_.cancel_at_panel();
  EXPECT_EQ(says(bytes(kMove)), hex(bytes("\x89")));
  EXPECT_EQ(says(bytes(kVersionQuery)), "d50381c402fa");
}

TEST_F(ReplicatorTraps, BuildingFromItsCardRefusesActions) {
  machine_.build_from_card();
  EXPECT_EQ(says(bytes(kMove)), hex(bytes("\x8A")));
  EXPECT_EQ(says(bytes(kVersionQuery)), "d50381c402fa") << "queries are answered";
}

TEST_F(ReplicatorTraps, OverheatedIsToldForEver) {
  machine_.overheat();
  for (int i = 0; i < 3; ++i) EXPECT_EQ(says(bytes(kVersionQuery)), hex(bytes("\x8B")));
}

TEST_F(ReplicatorTraps, AbortTakesEffectALittleLater) {
  says(bytes(s3g::build_start("a")) + bytes(std::string("\x85\x10\x27\0\0", 5)));
  EXPECT_EQ(says(bytes("\x07")), hex(bytes("\x81")));
  EXPECT_EQ(says(bytes(kStatistics)).substr(4, 4), "8101") << "still running";
  says("", 0.4);
  EXPECT_EQ(says(bytes(kStatistics)).substr(4, 4), "8104") << "cancelled";
}

const std::string kIsFinished("\x0B", 1);
const std::string kPosition("\x15", 1);

// The answer to the position query where x is so many steps and the others are 0.
std::string stands_at(char x) {
  return hex(bytes(std::string("\x81") + x + std::string(4 * 5 - 1 + 2, '\0')));
}

// x: 100 steps, 10 mm at 10 mm/s.
const std::string kMoveOfASecond = std::string("\x9B\x64\0\0\0", 5) + std::string(20, '\0') +
                                   std::string("\0\0\0\x20\x41\x80\x02", 7);

TEST_F(ReplicatorTraps, IsFinishedThoughItsLastMoveIsNot) {
  says(bytes(kMoveOfASecond));
  EXPECT_EQ(says(bytes(kIsFinished)), hex(bytes("\x81\x01")));
  says("", 0.47);
  const std::string halfway = says(bytes(kPosition));
  EXPECT_NE(halfway, stands_at(0));
  EXPECT_NE(halfway, stands_at(100));
  says("", 1);
  EXPECT_EQ(says(bytes(kPosition)), stands_at(100));
}

TEST_F(ReplicatorTraps, APositionThatIsSetIsShownWithTheNextMove) {
  says(bytes(std::string("\x8C\x32\0\0\0", 5) + std::string(16, '\0')));
  EXPECT_EQ(says(bytes(kPosition)), stands_at(0));
  says(bytes(kMoveOfASecond), 1.1);
  EXPECT_EQ(says(bytes(kPosition)), stands_at(100));
}

TEST_F(ReplicatorTraps, ExecutedActionsAreCountedWhereItWasBuiltSo) {
  Replicator counting(kRealTime, with("counts_actions=on"));
  for (Replicator* machine : {&machine_, &counting}) {
    Wire wire(*machine);
    wire.says(bytes(s3g::build_start("a")) + bytes(std::string("\x96\0\0", 3)));
    const std::string count = machine == &counting ? "01000000" : "00000000";
    EXPECT_EQ(hex(wire.says(bytes(kStatistics))).substr(12, 8), count);
  }
}

std::optional<Error> print(FaultyPort& port, const X3gProgram& program) {
  PrintControl control;
  return print(port, false, program.bytes, control);
}

TEST(ReplicatorLink, ACardChosenInMidPrintEndsIt) {
  Replicator machine(kRealTime);
  FaultyPort port(machine);
  bool done = false;
  port.on_step = [&](std::size_t) {
    if (port.now_s() > 20 && !std::exchange(done, true)) machine.build_from_card();
  };
  const auto failure = print(port, x3g_program(100));
  ASSERT_TRUE(failure);
  EXPECT_EQ(failure->fault(), Fault::kIo);
  EXPECT_THAT(failure->what(), HasSubstr("from its own card"));
  EXPECT_NE(port.executed().back(), "abort") << "the other build is left alone";
}

// Each trap alone, over a line that splits what it carries.
class EachReplicatorTrap : public ::testing::TestWithParam<std::string> {};

TEST_P(EachReplicatorTrap, IsPrintedThrough) {
  const X3gProgram program = x3g_program(120);
  for (const char* value : {"=on", "=off"}) {
    Replicator machine(kRealTime, with(GetParam() + value));
    FaultyPort port(machine, {.split = 0.5}, 7);
    const auto failure = print(port, program);
    EXPECT_FALSE(failure) << value << ": " << failure->what();
    EXPECT_EQ(port.executed(), program.actions) << value;
  }
}

INSTANTIATE_TEST_SUITE_P(All, EachReplicatorTrap,
                         ::testing::ValuesIn(simulated::replicator_trait_names()),
                         [](const auto& trap) { return trap.param; });

}  // namespace
}  // namespace packmerger::test
