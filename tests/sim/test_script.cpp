// The lines and actions of a print: what they are after all that is done to them, and what they
// take.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "firmware_io/gcode/gcode.h"
#include "firmware_io/gcode/gcode_script.h"
#include "firmware_io/s3g/s3g_actions.h"
#include "sim/programs.h"

namespace packmerger::test {
namespace {

using ::testing::ElementsAre;

std::vector<std::string> lines_of(const GcodeScript& script) {
  std::vector<std::string> lines;
  for (std::size_t i = 0; i < script.size(); ++i) lines.emplace_back(script[i]);
  return lines;
}

TEST(GcodeScript, HoldsTheProgramAndWhatComesBetween) {
  const std::string program = "G28 ; home\n; \n  G1 X1 F600\r\n\nG1 X2\nM84";
  GcodeScript script(program);
  EXPECT_THAT(lines_of(script), ElementsAre("G28", "G1 X1 F600", "G1 X2", "M84"));
  script.insert(1, {"M400", "G91"});
  script.append("M400");
  script.replace(4, "M105");
  EXPECT_THAT(lines_of(script),
              ElementsAre("G28", "M400", "G91", "G1 X1 F600", "M105", "M84", "M400"));
  for (const auto& [count, program_lines] :
       std::vector<std::pair<std::size_t, std::size_t>>{{0, 0}, {1, 1}, {3, 1}, {6, 4}, {9, 4}})
    EXPECT_EQ(script.program_lines(count), program_lines) << count;
  script.insert(6, {"M105"});
  EXPECT_EQ(script.program_lines(8), 4u);
  EXPECT_TRUE(script.is_own(6));
  EXPECT_FALSE(script.is_own(0));
  script.shorten(3);
  EXPECT_EQ(script.program_lines(9), 1u);
  EXPECT_THAT(lines_of(script), ElementsAre("G28", "M400", "G91"));
}

TEST(GcodeScript, ModesAreTheLastOnes) {
  const std::string program = "G90\nM82\nG1 X1 F600\nM83\nG1 X2 F700 E1\nG91\nG1 F800";
  const GcodeScript script(program);
  EXPECT_THAT(script.modes(5), ElementsAre("G90", "M83", "G1 F700"));
  EXPECT_THAT(script.modes(2), ElementsAre("G90", "M82"));
  EXPECT_THAT(script.modes(0), ElementsAre());
}

// A program of 200 MB has eight million lines, and lies in memory for as long as it is printed.
TEST(GcodeScript, TakesEightBytesALine) {
  constexpr std::size_t kLines = 100'000;
  std::string program;
  for (std::size_t i = 0; i < kLines; ++i) program += "G1 X101.123 Y99.456 E0.01234\n";
  GcodeScript script(program);
  ASSERT_EQ(script.size(), kLines);
  EXPECT_EQ(script.bytes(), 8 * kLines);
  script.insert(kLines / 2, {"M400"});
  EXPECT_LT(script.bytes(), 8 * kLines + 1000);
}

TEST(X3gActions, TakeFourBytesEach) {
  const X3gProgram program = x3g_program(10'000);
  const s3g::Actions actions(program.bytes);
  ASSERT_EQ(actions.size(), program.actions.size());
  EXPECT_EQ(actions.bytes(), 4 * actions.size());
}

TEST(X3gActions, AreCompletedWhereAStartOrAnEndIsMissing) {
  const std::string start("\x99\0\0\0\0a\0", 7);
  const std::string delay("\x85\x01\0\0\0", 5);
  const std::string end("\x9A\0", 2);
  for (const bool has_start : {true, false})
    for (const bool has_end : {true, false}) {
      const std::string program = (has_start ? start : "") + delay + (has_end ? end : "");
      s3g::Actions actions(program);
      actions.complete("a");
      std::vector<std::string> all;
      for (const std::string_view action : actions) all.emplace_back(action);
      EXPECT_THAT(all, ElementsAre(start, delay, end));
      EXPECT_EQ(actions.done(0), has_start ? start.size() : 0);
      EXPECT_EQ(actions.done(1), program.size() - (has_end ? end.size() : 0));
      EXPECT_EQ(actions.done(2), program.size());
    }
}

}  // namespace
}  // namespace packmerger::test
