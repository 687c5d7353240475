// What proves that a printer is alive, and where it is: not what it says unasked, and no ok that is
// one too many.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <deque>

#include "firmware_io/gcode/heat_watch.h"
#include "firmware_io/simulated/marlin.h"
#include "sim/programs.h"
#include "sim/scenario.h"

namespace packmerger::test {
namespace {

using simulated::Marlin;
using simulated::MarlinTraits;
using simulated::Pace;
using ::testing::HasSubstr;

TEST(Life, AQuarterOfAnHourOfHeatingInKlippersWay) {
  MarlinTraits traits;
  traits.heats_quietly = true;
  for (const bool autoreport : {true, false}) {
    traits.autoreport = autoreport;
    Marlin firmware(Pace{1, false}, traits);
    FaultyPort port(firmware);
    PrintControl control;
    StreamOptions options = scenario_options();
    options.timeout_s = 5;
    const auto failure =
        print(port, true, "M190 S921\nG28\nG1 X1\n", control, {}, options);  // 1 °C/s
    EXPECT_FALSE(failure) << failure->what();
    EXPECT_GT(port.now_s(), 900);
  }
}

// Holds its heat for ten minutes before it says ok: the temperature stands still meanwhile, and
// nothing but what is told of the wait (W:) proves that it is alive.
class Loiterer : public simulated::Firmware {
 public:
  explicit Loiterer(std::string report) : report_(std::move(report)) {}

  void receive(std::string_view bytes, double now_s) override {
    for (const char c : bytes) {
      if (c != '\n') {
        line_ += c;
        continue;
      }
      if (!line_.empty()) waiting_.push_back(line_);
      line_.clear();
    }
    advance(now_s);
  }
  void advance(double now_s) override {
    while (!waiting_.empty() || until_s_ > 0) {
      if (until_s_ == 0 && command_of(waiting_.front()) == "M109 S200") {
        until_s_ = now_s + 600;
        next_s_ = now_s;
      }
      if (now_s < until_s_) break;
      output_ += command_of(waiting_.front()) == "M114" ? "X:0 Y:0 Z:0 E:0\nok\n"
                                                        : polite(waiting_.front());
      executed_.push_back(command_of(waiting_.front()));
      waiting_.pop_front();
      until_s_ = 0;
    }
    if (until_s_ == 0 || now_s < next_s_) return;
    output_ += report_;
    next_s_ = now_s + 1;
  }
  double next_event_s() const override {
    return until_s_ > 0 ? std::min(next_s_, until_s_) : simulated::kNever;
  }

 private:
  std::string report_;
  std::string line_;
  std::deque<std::string> waiting_;
  double until_s_ = 0;
  double next_s_ = 0;
};

TEST(Life, IsProvenByAWaitThatIsToldThoughTheHeatStandsStill) {
  for (const bool tells : {true, false}) {
    Loiterer firmware(tells ? "T:200.0 /200.0 B:60.0 /60.0 @:64 W:9\n"
                            : "T:200.0 /200.0 B:60.0 /60.0 @:64\n");
    FaultyPort port(firmware);
    PrintControl control;
    StreamOptions options = scenario_options();
    options.timeout_s = 5;
    const auto failure = print(port, true, "G28\nM109 S200\nG1 X1\n", control, {}, options);
    EXPECT_EQ(failure.has_value(), !tells);
    EXPECT_EQ(port.now_s() > 600, tells);
  }
}

// Reports come for ever, and nothing moves.
TEST(Life, AHeaterThatStandsStillIsNoSign) {
  HeatWatch watch;
  watch.begin("M190 S60");
  EXPECT_TRUE(watch.comes_nearer({{"bed", 30.0, 60.0}, {"tool", 20.0, 200.0}}));
  EXPECT_TRUE(watch.comes_nearer({{"bed", 30.1, 60.0}}));
  EXPECT_FALSE(watch.comes_nearer({{"bed", 30.1, 60.0}, {"tool", 90.0, 200.0}}));
  EXPECT_FALSE(watch.comes_nearer({{"bed", 30.0, 60.0}}));
  watch.begin("M109 R50");
  EXPECT_TRUE(watch.comes_nearer({{"tool 0", 90.0, 50.0}}));
  EXPECT_TRUE(watch.comes_nearer({{"tool 0", 80.0, 50.0}})) << "it cools";
  watch.begin("G28");
  EXPECT_FALSE(watch.comes_nearer({{"tool 0", 70.0, 50.0}}));
}

// However long it lasts and however seldom the printer says so.
TEST(Life, BusyAlwaysCounts) {
  for (const char* every : {"M113 S2", "M113 S10", "M113 S40"}) {
    Marlin firmware(Pace{1, false});
    FaultyPort port(firmware);
    PrintControl control;
    StreamOptions options = scenario_options();
    options.timeout_s = 10;
    const auto failure =
        print(port, true, std::string(every) + "\nG4 S3600\nG1 X1\n", control, {}, options);
    EXPECT_FALSE(failure) << every << failure->what();
    EXPECT_LT(count(port.executed(), "M105"), 20u) << "what it does not read must not pile up";
  }
}

TEST(Life, ADwellMayTakeWhatItStates) {
  MarlinTraits traits;
  traits.busy = false;
  for (const char* dwell : {"G4 S3600", "G4 P3600000"}) {
    Marlin firmware(Pace{1, false}, traits);
    FaultyPort port(firmware);
    PrintControl control;
    StreamOptions options = scenario_options();
    options.timeout_s = 10;
    const auto failure = print(port, true, std::string(dwell) + "\nG1 X1\n", control, {}, options);
    EXPECT_FALSE(failure) << dwell << failure->what();
  }
}

TEST(Life, ALostOkIsNoticedWhateverThePrinterTellsUnasked) {
  for (const char* trait : {"positions_unasked", "reports_unasked", "chatters"}) {
    MarlinTraits traits;
    simulated::set_trait(traits, trait);
    Marlin firmware(Pace{1, true}, traits);
    FaultyPort port(firmware);
    lose_answers_behind(port, 20);
    PrintControl control;
    const auto failure = print(port, true, joined(gcode_program(200)), control);
    EXPECT_FALSE(failure) << trait << failure->what();
    EXPECT_EQ(only(port.executed(), gcode_program(200)), gcode_program(200));
    EXPECT_LT(port.now_s(), 60) << trait;
  }
}

// It says so every second, and asks for the lost line whatever it is asked itself.
TEST(Life, APrinterWithNothingToDoOwesNoAnswer) {
  MarlinTraits traits;
  traits.idle_wait = true;
  Marlin firmware(Pace{1, true}, traits);
  FaultyPort port(firmware);
  bool lost = false;
  port.on_send = [&](std::string& bytes) {
    if (bytes.starts_with("N40 ") && !std::exchange(lost, true)) bytes.clear();
  };
  PrintControl control;
  const auto failure = print(port, true, joined(gcode_program(100)), control);
  EXPECT_FALSE(failure) << failure->what();
  EXPECT_EQ(only(port.executed(), gcode_program(100)), gcode_program(100));
}

// The end is not proven by a position that nobody asked for.
TEST(Life, PositionsAreSilencedBeforeTheEndIsProven) {
  MarlinTraits traits;
  traits.positions_unasked = true;
  Marlin firmware(Pace{1, false}, traits);
  FaultyPort port(firmware);
  PrintControl control;
  const auto failure = print(port, true, joined(gcode_program(50)), control);
  EXPECT_FALSE(failure) << failure->what();
  EXPECT_EQ(count(port.executed(), "M154 S0"), 1u);
  EXPECT_EQ(only(port.executed(), gcode_program(50)), gcode_program(50));
}

// Which is no command of older firmware, and would be told as one that the printer passes over.
TEST(Life, ThePositionBehindHomingIsNotUnasked) {
  Marlin firmware(Pace{1, false});
  FaultyPort port(firmware);
  PrintControl control;
  EXPECT_FALSE(print(port, true, "G28\n" + joined(gcode_program(50)), control));
  EXPECT_THAT(port.executed(), ::testing::Contains("G28"));
  EXPECT_EQ(count(port.executed(), "M154 S0"), 0u);
}

// How far the host is ahead of the printer at most, over a line that doubles answers and hands
// them over in pieces. One line is on its way, so a lead of two is an ok too many.
std::size_t longest_lead(MarlinTraits traits, FaultRates rates) {
  Marlin firmware(Pace{1, false}, traits);
  FaultyPort port(firmware, rates, 3);
  const std::vector<std::string> program = gcode_program(600);
  std::size_t lead = 0;
  std::size_t seen = 0;
  port.on_step = [&](std::size_t) {
    if (port.sent.size() == seen) return;
    seen = port.sent.size();
    const std::size_t at = port.sent.rfind('\n', port.sent.size() - 2) + 1;
    const std::string command = command_of(port.sent.substr(at, port.sent.size() - at - 1));
    const auto line = std::find(program.begin(), program.end(), command);
    if (line == program.end()) return;  // a question
    const auto given = static_cast<std::size_t>(line - program.begin()) + 1;
    const std::size_t executed = only(port.executed(), program).size();
    if (given > executed) lead = std::max(lead, given - executed);
  };
  PrintControl control;
  const auto failure = print(port, true, joined(program), control);
  EXPECT_FALSE(failure) << failure->what();
  EXPECT_EQ(only(port.executed(), program), program);
  return lead;
}

// Takes a fiftieth of a second for each line; behind two of them one more ok comes a moment later,
// when the next line is on its way already and seems to be answered by it.
class LateOks : public simulated::Firmware {
 public:
  std::vector<std::size_t> on_its_way;  // with each line of the program: how many lack an answer

  void receive(std::string_view bytes, double now_s) override {
    for (const char c : bytes) {
      if (c != '\n') {
        line_ += c;
        continue;
      }
      if (!line_.empty()) take(std::exchange(line_, {}), now_s);
    }
  }
  void advance(double now_s) override {
    while (!answers_.empty() && answers_.front().first <= now_s) {
      output_ += answers_.front().second;
      answers_.pop_front();
    }
  }
  double next_event_s() const override {
    return answers_.empty() ? simulated::kNever : answers_.front().first;
  }

 private:
  static constexpr double kLine_s = 0.02;
  static constexpr const char* kSurplus = "ok late\n";

  void take(const std::string& line, double now_s) {
    const double due_s = std::max(now_s, free_at_s_) + kLine_s;
    free_at_s_ = due_s;
    answers_.emplace_back(due_s, answer(line));
    const auto unanswered = std::count_if(answers_.begin(), answers_.end(),
                                          [](const auto& each) { return each.second != kSurplus; });
    if (command_of(line).starts_with("G1"))
      on_its_way.push_back(static_cast<std::size_t>(unanswered));
    const bool surplus = line.starts_with("N120 ") || line.starts_with("N121 ");
    if (surplus) answers_.emplace_back(due_s + kLine_s / 2, kSurplus);
  }

  std::string answer(const std::string& line) {
    const bool numbered = line.starts_with("N");
    const long number = numbered ? std::atol(line.c_str() + 1) : 0;
    const bool garbled = number == 3 && !std::exchange(asked_, true);
    if (garbled || number > last_ + 1) return "Resend: " + std::to_string(last_ + 1) + "\nok\n";
    if (numbered) last_ = number;
    if (line.find("M114") != std::string::npos) return "X:0 Y:0 Z:0 E:0\nok\n";
    return command_of(line) == "M105" ? "ok T:20 /0 B:20 /0\n" : polite(line);
  }

  std::string line_;
  long last_ = 0;
  bool asked_ = false;  // for a line, so that it is known to count them
  double free_at_s_ = 0;
  std::deque<std::pair<double, std::string>> answers_;
};

// Nothing tells them from the answers that they are taken for, but M105 behind every hundredth
// line.
TEST(SurplusOks, ThatCameLateAreMadeUpForByTheNextProof) {
  LateOks firmware;
  FaultyPort port(firmware);
  PrintControl control;
  const auto failure = print(port, true, joined(gcode_program(250)), control);
  EXPECT_FALSE(failure) << failure->what();
  const std::size_t most =
      *std::max_element(firmware.on_its_way.begin(), firmware.on_its_way.end());
  EXPECT_GE(most, 3u) << "two lines ahead of the answers";
  ASSERT_GT(firmware.on_its_way.size(), 240u);
  // by the move; proven behind line 203, of which some are none
  EXPECT_EQ(firmware.on_its_way[190], 3u) << "two lines ahead of the answers";
  for (std::size_t i = 200; i < 240; ++i) EXPECT_EQ(firmware.on_its_way[i], 1u) << i;
}

// It has no heater, so its answers to M105 are known by their numbers alone.
TEST(NamedOks, AreForQuestionsToo) {
  Parrot firmware([](const std::string& line) -> std::string {
    if (!line.starts_with("N") || line.starts_with("N0 ")) return polite(line);
    const std::string ok = "ok N" + std::to_string(std::atol(line.c_str() + 1)) + " P15 B3\n";
    return command_of(line) == "M114" ? "X:0 Y:0 Z:0 E:0\n" + ok : ok;
  });
  FaultyPort port(firmware);
  PrintControl control;
  const auto failure = print(port, true, joined(gcode_program(250)), control);
  EXPECT_FALSE(failure) << failure->what();
  EXPECT_THAT(port.sent, HasSubstr(" M105*"));
  EXPECT_EQ(port.sent.find("\n\n"), std::string::npos) << "no answer was missed";
}

TEST(SurplusOks, OpenNothing) {
  MarlinTraits doubled;
  doubled.doubled_ok = true;
  EXPECT_LE(longest_lead(doubled, {}), 2u);
  EXPECT_LE(longest_lead(doubled, {.split = 1}), 8u);
  EXPECT_LE(longest_lead({}, {.duplicate = 0.1, .split = 1}), 8u);
  doubled.advanced_ok = true;
  EXPECT_LE(longest_lead(doubled, {.split = 1}), 3u) << "the printer names its lines";
}

}  // namespace
}  // namespace packmerger::test
