// The lines of a print: what they are after all that is done to them, and what they take.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "firmware_io/gcode.h"
#include "firmware_io/gcode_script.h"

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
  script.shorten(3);
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

}  // namespace
}  // namespace packmerger::test
