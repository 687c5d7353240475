// Over a channel that damages what it carries, every command is executed exactly once and in order,
// or the print fails with a cause and nothing more of it is executed.
#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <optional>

#include "firmware_io/simulated/marlin.h"
#include "firmware_io/simulated/replicator.h"
#include "sim/programs.h"
#include "sim/scenario.h"

namespace packmerger::test {
namespace {

// Rapidcheck's parameters for a long run; otherwise the same 200 cases every time, under sanitizers
// too. A failure prints how to reproduce it.
const char* const kLongRun = std::getenv("PACKMERGER_LONG_RUN");
const int kParameters =
    ::setenv("RC_PARAMS", kLongRun != nullptr ? kLongRun : "seed=20140801 max_success=200", 1);

constexpr std::size_t kCommands = 500;

// How many packets a property must have seen.
const std::size_t kLeastPackets = kLongRun != nullptr ? 1000000 : 10000;

StreamOptions options() {
  StreamOptions options;
  options.timeout_s = 10;
  options.boot_wait_s = 0.1;
  options.safe_gcode = "M104 S0\nM140 S0\n";
  return options;
}

FaultRates any_rates() {
  const auto rate = [] { return *rc::gen::inRange(0, 8) / 200.0; };
  FaultRates rates;
  rates.drop_byte = rate();
  rates.drop_chunk = rate();
  rates.flip = rate();
  rates.duplicate = rate();
  rates.delay = rate();
  rates.split = 0.5;
  if (*rc::gen::inRange(0, 4) == 0) rates.mishap = 1.0 / kCommands;
  if (*rc::gen::inRange(0, 8) == 0) rates.unplug = 1.0 / kCommands;
  return rates;
}

template <typename Print>
std::optional<Error> failure_of(const Print& print) {
  try {
    print();
  } catch (const Error& error) {
    return error;
  }
  return std::nullopt;
}

bool is_prefix(const std::vector<std::string>& part, const std::vector<std::string>& whole) {
  return part.size() <= whole.size() && std::equal(part.begin(), part.end(), whole.begin());
}

// A cause that names a mishap is told only where it happened.
// breaks: the machine stops of its own.
void expect_true_cause(const Error& error, FaultyPort& port, const std::string& mishap,
                       bool breaks = false) {
  const bool built_alone = error.fault() == Fault::kBusy && mishap == "card";
  RC_ASSERT(error.fault() == Fault::kIo || error.fault() == Fault::kUnavailable || built_alone);
  RC_ASSERT(!error.hint().empty());
  const std::string what = error.what();
  RC_ASSERT(!what.empty());
  const auto says = [&](const char* text) { return what.find(text) != std::string::npos; };
  if (says("has ended")) RC_ASSERT(port.was_unplugged());
  // A stopped Marlin's own words are "Temperature is reset".
  if (says("was reset")) RC_ASSERT(port.had_mishap() && mishap == "reset");
  // A flipped bit makes M112 of M110, which an emergency parser obeys.
  const auto& executed = port.executed();
  const bool halted = std::find(executed.begin(), executed.end(), "halt") != executed.end();
  if (says("halted") || says("stopped") || says("heater") || says("refuses"))
    RC_ASSERT(halted || breaks || (port.had_mishap() && mishap == "heater"));
  if (says("its own card")) RC_ASSERT(port.had_mishap() && mishap == "card");
  if (says("cancelled at")) RC_ASSERT(port.had_mishap() && mishap == "panel");
}

// In some of the prints somebody pauses and goes on.
void pause_sometimes(FaultyPort& port, PrintControl& control) {
  if (*rc::gen::arbitrary<bool>()) return;
  const auto at = *rc::gen::inRange<std::size_t>(5, 150);
  port.on_step = [&port, &control, at, paused_s = 0.0, ended = false](std::size_t written) mutable {
    if (written >= at && paused_s == 0) {
      control.pause();
      paused_s = port.now_s();
    } else if (paused_s > 0 && port.now_s() > paused_s + 100 && !std::exchange(ended, true)) {
      control.resume();
    }
  };
}

struct Tally {
  std::size_t prints = 0;
  std::size_t through = 0;
  std::size_t mishaps = 0;
  std::size_t unplugged = 0;
  std::size_t faults = 0;
  std::size_t packets = 0;

  // breaks: the machine stopped of its own.
  void add(const FaultyPort& port, bool failed, bool breaks = false) {
    ++prints;
    through += failed ? 0 : 1;
    mishaps += port.had_mishap() || breaks ? 1 : 0;
    unplugged += port.was_unplugged() ? 1 : 0;
    faults += port.faults();
    packets += port.chunks();
  }

  void check(const std::string& property) const {
    std::cout << property << ": " << packets << " packets in " << prints << " prints, " << through
              << " through; " << faults << " faults, " << mishaps << " mishaps, " << unplugged
              << " unplugged\n";
    EXPECT_GE(packets, kLeastPackets);
    EXPECT_GT(through, prints / 3) << "faults that can be put right must be";
    EXPECT_GT(faults, packets / 100);
    EXPECT_GT(mishaps, 0U);
    EXPECT_GT(unplugged, 0U);
  }
};

// What the machine makes of its queue when nobody speaks to it any more.
constexpr double kAfterwards_s = 600;

void cause(const std::string& mishap, simulated::Marlin& machine) {
  mishap == "reset" ? machine.reset() : machine.fail_heater();
}

// In a few prints the printer stops, says "fatal:" or refuses a move with a certain line. Returns
// whether it does.
bool break_sometimes(simulated::MarlinTraits& traits) {
  if (*rc::gen::inRange(0, 16) != 0) return false;
  const std::string name = *rc::gen::elementOf(simulated::marlin_line_trait_names());
  const auto at = *rc::gen::inRange<std::size_t>(10, kCommands);
  return set_trait(traits, name + "=" + std::to_string(at));
}

void check_gcode_print(Tally& tally, simulated::MarlinTraits traits) {
  const bool instant = *rc::gen::arbitrary<bool>();
  // Now and then something in which firmwares differ.
  for (const std::string& name : simulated::marlin_trait_names())
    // What is garbled on its way to a printer that checks no sums, nobody can put right.
    if (name != "counts_lines" && *rc::gen::inRange(0, 20) == 0)
      simulated::set_trait(traits, name + (*rc::gen::arbitrary<bool>() ? "=on" : "=off"));
  const bool breaks = break_sometimes(traits);
  simulated::Marlin firmware(simulated::Pace{1, instant}, traits);
  FaultyPort port(firmware, any_rates(), *rc::gen::arbitrary<std::uint64_t>());
  const auto mishap = *rc::gen::element<std::string>("reset", "heater");
  port.on_mishap = [&] { cause(mishap, firmware); };
  const std::vector<std::string> program = gcode_program(kCommands);
  PrintControl control;
  pause_sometimes(port, control);
  StreamOptions windowed = options();
  windowed.pause_gcode = "M117 standing";
  windowed.window_bytes = *rc::gen::element<std::size_t>(0, 40, 96);
  const auto failure =
      failure_of([&] { print_gcode(port, joined(program), windowed, {}, control); });
  tally.add(port, failure.has_value(), breaks);
  port.leave_alone(kAfterwards_s);
  const std::vector<std::string> executed = only(port.executed(), program);
  RC_ASSERT(is_prefix(executed, program));
  if (failure)
    expect_true_cause(*failure, port, mishap, breaks);
  else
    RC_ASSERT(executed.size() == program.size());
}

TEST(FaultyChannel, GcodeOnMarlin2IsExactOrFails) {
  Tally tally;
  EXPECT_TRUE(rc::check([&] { check_gcode_print(tally, {}); }));
  tally.check("G-code on Marlin 2.1");
}

TEST(FaultyChannel, GcodeOnMarlin1IsExactOrFails) {
  Tally tally;
  EXPECT_TRUE(rc::check([&] { check_gcode_print(tally, simulated::marlin_1_1()); }));
  tally.check("G-code on Marlin 1.1");
}

void cause(const std::string& mishap, simulated::Replicator& machine) {
  if (mishap == "reset") machine.power_cycle();
  if (mishap == "heater") machine.overheat();
  if (mishap == "card") machine.build_from_card();
  if (mishap == "panel") machine.cancel_at_panel();
}

void check_x3g_print(Tally& tally) {
  const bool instant = *rc::gen::arbitrary<bool>();
  simulated::Replicator firmware(simulated::Pace{1, instant});
  FaultRates rates = any_rates();
  const bool doubles = *rc::gen::inRange(0, 4) == 0;
  // s3g numbers nothing: where a doubled packet's second answer is lost or late too, nobody can
  // tell, so doubling is played alone.
  if (doubles)
    rates = {.duplicate = rates.duplicate, .split = rates.split};
  else
    rates.duplicate = 0;
  FaultyPort port(firmware, rates, *rc::gen::arbitrary<std::uint64_t>());
  const std::string mishap = *rc::gen::element<std::string>("reset", "heater", "card", "panel");
  port.on_mishap = [&] { cause(mishap, firmware); };
  const X3gProgram program = x3g_program(kCommands);
  PrintControl control;
  pause_sometimes(port, control);
  const auto failure = failure_of([&] { print_x3g(port, program.bytes, options(), {}, control); });
  tally.add(port, failure.has_value());
  port.leave_alone(kAfterwards_s);
  std::vector<std::string> executed = port.executed();
  // A build start that the channel doubled names the build again and begins the count anew.
  if (doubles && executed.size() > 1 && executed[0] == executed[1])
    executed.erase(executed.begin());
  if (failure) {
    expect_true_cause(*failure, port, mishap);
    if (!executed.empty() && executed.back() == "abort") executed.pop_back();
    // A packet that the channel doubled is executed twice before anyone can know.
    if (doubles) executed.erase(std::unique(executed.begin(), executed.end()), executed.end());
    RC_ASSERT(is_prefix(executed, program.actions));
  } else {
    RC_ASSERT(executed == program.actions);
  }
}

TEST(FaultyChannel, X3gIsExactOrFails) {
  Tally tally;
  EXPECT_TRUE(rc::check([&] { check_x3g_print(tally); }));
  tally.check("x3g on Sailfish");
}

TEST(FaultyChannel, EndsWithTheChannel) {
  EXPECT_TRUE(rc::check([&] {
    const bool gcode = *rc::gen::arbitrary<bool>();
    simulated::Marlin marlin(simulated::Pace{1, true});
    simulated::Replicator replicator(simulated::Pace{1, true});
    simulated::Firmware& firmware = gcode ? static_cast<simulated::Firmware&>(marlin) : replicator;
    FaultyPort port(firmware);
    port.end_after = *rc::gen::inRange<std::size_t>(0, 60);
    PrintControl control;
    const double began_s = port.now_s();
    const auto failure = failure_of([&] {
      if (gcode)
        print_gcode(port, joined(gcode_program(kCommands)), options(), {}, control);
      else
        print_x3g(port, x3g_program(kCommands).bytes, options(), {}, control);
    });
    RC_ASSERT(failure.has_value());
    const bool in_first_words = failure->fault() == Fault::kUnavailable;
    RC_ASSERT(in_first_words || failure->what() == std::string("The channel has ended"));
    RC_ASSERT(port.now_s() - began_s < 5);
  }));
}

}  // namespace
}  // namespace packmerger::test
