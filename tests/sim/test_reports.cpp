// What a link tells of the machine and of its print.
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

// In the middle of the moves, whatever heating took: the machines do as the programs state, except
// that this Marlin is three times as slow as the slicer believed.
TEST(Links, RemainingTimeIsLearned) {
  for (const bool gcode : {true, false}) {
    for (const bool marks : {false, true}) {
      if (!gcode && marks) continue;
      Marlin marlin(Pace{1, false});
      Replicator replicator(Pace{1, false});
      FaultyPort port(gcode ? static_cast<simulated::Firmware&>(marlin) : replicator);
      std::vector<std::string> lines = gcode_program(0);
      constexpr int kMoves = 2000;  // of three seconds
      for (int i = 0; i < kMoves; ++i) {
        if (marks && i % 20 == 0) lines.push_back("M73 P1 R" + std::to_string((kMoves - i) / 60));
        lines.push_back("G1 X" + std::to_string(i % 2 * 60) + " F1200");
      }
      std::vector<PrintReport> reports;
      std::vector<double> times_s;
      PrintControl control;
      const auto failure = print(port, gcode, gcode ? joined(lines) : x3g_program(20000).bytes,
                                 control, [&](const PrintReport& report) {
                                   reports.push_back(report);
                                   times_s.push_back(port.now_s());
                                 });
      ASSERT_FALSE(failure) << failure->what();
      for (std::size_t i = 0; i < reports.size(); ++i) {
        const double done =
            static_cast<double>(reports[i].done) / static_cast<double>(reports[i].total);
        if (done < 0.45 || done > 0.55) continue;
        const double truly_left_s = times_s.back() - times_s[i];
        ASSERT_TRUE(reports[i].remaining_s);
        EXPECT_NEAR(*reports[i].remaining_s / truly_left_s, 1, 0.25) << gcode << marks << done;
        EXPECT_NEAR(reports[i].elapsed_s, times_s[i], 1);
      }
    }
  }
}

// So that a print that failed is known to have begun, however early that was.
TEST(Links, PrintingIsToldBeforeAnythingIsSent) {
  for (const bool gcode : {true, false}) {
    Marlin marlin(Pace{1, false});
    Replicator replicator(Pace{1, false});
    simulated::Firmware& firmware = gcode ? static_cast<simulated::Firmware&>(marlin) : replicator;
    FaultyPort port(firmware);
    const std::vector<std::string> lines{"G28", "G1 X20 F1200", "G1 X30 F1200"};
    PrintControl control;
    const auto failure = print(port, gcode, gcode ? joined(lines) : x3g_program(100).bytes, control,
                               [](const PrintReport& report) {
                                 if (report.state != PrintState::kConnecting)
                                   throw Error(Fault::kCannotWrite, "no further", "");
                               });
    ASSERT_TRUE(failure);
    EXPECT_EQ(failure->fault(), Fault::kCannotWrite);
    if (gcode)
      EXPECT_TRUE(only(port.executed(), lines).empty());
    else
      EXPECT_TRUE(port.executed().empty()) << port.executed().front();
  }
}

TEST(Links, TemperaturesAreToldAsNumbers) {
  for (const int machine : {0, 1, 2}) {
    MarlinTraits traits;
    traits.autoreport = machine == 1;  // or they are asked for
    Marlin marlin(Pace{1, false}, traits);
    Replicator replicator(Pace{1, false});
    const bool gcode = machine < 2;
    FaultyPort port(gcode ? static_cast<simulated::Firmware&>(marlin) : replicator);
    PrintControl control;
    std::vector<HeaterReport> heaters;
    const auto failure =
        print(port, gcode, gcode ? joined(gcode_program(3000)) : x3g_program(1000).bytes, control,
              [&](const PrintReport& report) { heaters = report.heaters; });
    ASSERT_FALSE(failure) << failure->what();
    ASSERT_FALSE(heaters.empty());
    EXPECT_EQ(heaters[0].name, "tool");
    EXPECT_NEAR(heaters[0].actual_c, gcode ? 200 : 220, 1);
    EXPECT_NEAR(heaters[0].target_c.value(), gcode ? 200 : 220, 1);
    EXPECT_EQ(heaters.size(), gcode ? 2u : 1u);
    EXPECT_EQ(heaters.back().name, gcode ? "bed" : "tool");
    EXPECT_EQ(count(port.executed(), "M155 S0"), machine == 1 ? 1u : 0u);
  }
}

// The profile's link.machine against what the simulated machines say.
TEST(Links, OnlyTheMachineThatIsWanted) {
  struct Case {
    bool gcode;
    const char* wanted;
    bool fits;
  };
  for (const auto& [gcode, wanted, fits] :
       {Case{true, "packmerger", true}, Case{true, "Marlin 2.1.2", true},
        Case{true, "Prusa MK3", false}, Case{true, "PROTOCOL", false},
        Case{false, "Sailfish 7.8", true}, Case{false, "MakerBot", false}}) {
    Marlin marlin(Pace{1, true});
    Replicator replicator(Pace{1, true});
    FaultyPort port(gcode ? static_cast<simulated::Firmware&>(marlin) : replicator);
    PrintControl control;
    StreamOptions options = scenario_options();
    options.machine = wanted;
    const auto failure =
        print(port, gcode, gcode ? "G28\n" : x3g_program(2).bytes, control, {}, options);
    EXPECT_EQ(failure.has_value(), !fits) << wanted;
    if (!failure) continue;
    EXPECT_EQ(failure->fault(), Fault::kUnavailable);
    EXPECT_THAT(failure->what(), HasSubstr(wanted));
    EXPECT_THAT(failure->what(), HasSubstr(gcode ? "PackMerger (Marlin 2.1.2" : "Sailfish 7.8"));
    EXPECT_EQ(count(port.executed(), "G28"), 0u);
  }
}

}  // namespace
}  // namespace packmerger::test
