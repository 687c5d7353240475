// Our framing and our reading of x3g against gpx and s3gdump, which nobody here wrote, on programs
// for several machines.
#include <gtest/gtest.h>

#include <regex>
#include <string>
#include <vector>

#include "base/files.h"
#include "base/process/process.h"
#include "firmware_io/s3g/s3g.h"
#include "firmware_io/s3g/s3g_actions.h"

namespace packmerger::test {
namespace {

// Heating, homing, messages, tools and moves: every kind of command that gpx writes for a print.
std::string gcode() {
  std::string text =
      "M136 (start)\nM73 P0\nG162 X Y F2500\nG161 Z F1100\nG92 X0 Y0 Z-5 A0 B0\nM132 X Y Z A B\n"
      "M104 S220 T0\nM140 S60 T0\nM133 T0\nM134 T0\nM126 T0\nM106 T0\n"
      "M70 P5 (A message that is too long for one packet to the panel)\nM72 P1\nM300 S440 P200\n"
      "G130 X20 Y20 Z20 A20 B20\nM135 T0\nG90\n";
  for (int i = 0; i < 400; ++i)
    text += "G1 X" + std::to_string(i % 50) + "." + std::to_string(i % 10) + " Y" +
            std::to_string(i % 31) + " Z" + std::to_string(0.2 + i / 40 * 0.2) + " E" +
            std::to_string(i * 0.05) + " F" + std::to_string(600 + 7 * i) + "\n";
  return text + "G4 P100\nM71 (press)\nM127 T0\nM107\nM104 S0 T0\nM18\nM73 P100\nM137\n";
}

std::string run(const fs::path& folder, const std::vector<std::string>& argv) {
  ProcessSpec spec;
  spec.argv = argv;
  spec.folder = folder;
  const ProcessResult result = run_process(spec, 30, {}, {}, std::size_t{64} << 20);
  EXPECT_TRUE(result.status.ok()) << result.err;
  return result.out;
}

class GpxMachine : public ::testing::TestWithParam<std::vector<std::string>> {
 protected:
  // What gpx makes of the program, x3g or framed.
  std::string made(bool framed) {
    const fs::path folder = folder_.path() / (framed ? "framed" : "bare");
    fs::create_directory(folder);
    write_file_whole(folder / "job.gcode", gcode());
    std::vector<std::string> argv = {"gpx", "-I", "-m"};
    argv.insert(argv.end(), GetParam().begin(), GetParam().end());
    if (framed) argv.emplace_back("-F");
    argv.insert(argv.end(), {"job.gcode", "job.x3g"});
    run(folder, argv);
    return read_file(folder / "job.x3g", 16 << 20);
  }
  const fs::path& folder() const { return folder_.path(); }

 private:
  TemporaryFolder folder_;
};

TEST_P(GpxMachine, FramesTheSameBytes) {
  std::string ours;
  const std::string program = made(false);
  for (const std::string_view action : s3g::Actions(program)) ours += s3g::packet(action);
  EXPECT_GT(ours.size(), 10000U);
  EXPECT_TRUE(ours == made(true)) << "differs from gpx -F";
}

std::int32_t coordinate(std::string_view action, std::size_t axis) {
  return static_cast<std::int32_t>(s3g::read_integer(action.substr(1 + 4 * axis, 4)));
}

// As s3gdump writes a command: its code, and where it moves to.
std::string as_dumped(std::string_view action) {
  const unsigned code = static_cast<std::uint8_t>(action[0]);
  std::string text = "(" + std::to_string(code) + ")";
  if (code != 155) return text;
  text += " (";
  for (std::size_t axis = 0; axis < 5; ++axis)
    text += (axis > 0 ? ", " : "") + std::to_string(coordinate(action, axis));
  return text + ")";
}

TEST_P(GpxMachine, ReadsTheSameCommands) {
  const std::string program = made(false);
  std::vector<std::string> ours;
  for (const std::string_view action : s3g::Actions(program)) ours.push_back(as_dumped(action));

  const std::string dump = run(folder() / "bare", {"s3gdump", "job.x3g"});
  const std::regex command(R"((?:^|\n)\d+: (\(\d+\))(?: Move to( \([^)]*\)), DDA)?)");
  std::vector<std::string> theirs;
  for (std::sregex_iterator found(dump.begin(), dump.end(), command), end; found != end; ++found)
    theirs.push_back((*found)[1].str() + (*found)[2].str());
  EXPECT_GT(theirs.size(), 400U);
  EXPECT_EQ(ours, theirs);
}

INSTANTIATE_TEST_SUITE_P(
    All, GpxMachine,
    ::testing::Values(std::vector<std::string>{"r1"}, std::vector<std::string>{"r1d"},
                      std::vector<std::string>{"r2"}, std::vector<std::string>{"r2h"},
                      std::vector<std::string>{"r2x"}, std::vector<std::string>{"fcp"},
                      std::vector<std::string>{"t7"}, std::vector<std::string>{"r1d", "-g"},
                      std::vector<std::string>{"r1d", "-p"}, std::vector<std::string>{"r1d", "-d"},
                      std::vector<std::string>{"r1d", "-w"},
                      std::vector<std::string>{"r2x", "-N", "ht"}));

}  // namespace
}  // namespace packmerger::test
