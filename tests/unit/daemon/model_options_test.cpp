#include "daemon/settings/model_options.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <fstream>
#include <sstream>

#include "base/error.h"
#include "base/files.h"
#include "daemon/intake/beside.h"

namespace packmerger {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class ModelOptionsTest : public testing::Test {
 protected:
  ModelOptions read(const std::string& text) {
    const fs::path file = folder_.path() / "a.stl.toml";
    std::ofstream(file, std::ios::binary) << text;
    return read_model_settings(file, read_profile("marlin"));
  }

  std::string refusal(const std::string& text) {
    try {
      read(text);
    } catch (const Error& error) {
      EXPECT_EQ(error.fault(), Fault::kBadProfile) << error.what();
      EXPECT_FALSE(error.hint().empty());
      return error.what();
    }
    return "accepted";
  }

  TemporaryFolder folder_;
};

TEST_F(ModelOptionsTest, EveryKeyBecomesItsOption) {
  EXPECT_THAT(
      arguments_of(read(R"(
size = 60
units = "in"
copies = 3
variant = "cheapest"
no_split = true
no_hollow = true
seed = 7
budget = 2.5
[set]
gap_mm = 0
build_mm = [100, 100, 300]
segmentation = "paper"
[set.fdm]
start_s = 60.5
[set.slicer.options]
fill_density = "20%"
)")),
      ElementsAre("--seed", "7", "--budget", "2.5", "--units", "in", "--size", "60", "--copies",
                  "3", "--variant", "cheapest", "--no-split", "--no-hollow", "--set",
                  "build_mm=100,100,300", "--set", "fdm.start_s=60.5", "--set", "gap_mm=0", "--set",
                  "segmentation=paper", "--set", "slicer.options.fill_density=20%"));
  EXPECT_THAT(arguments_of(read("scale = 0.5\nno_split = false")), ElementsAre("--scale", "0.5"));
  EXPECT_THAT(arguments_of(read("# nothing\n")), IsEmpty());
}

TEST_F(ModelOptionsTest, TellsNameLineAndWhatWasExpected) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"size = 0\n", "a.stl.toml:1: size: expected a number above 0"},
      {"\n\nscale = \"2\"\n", "a.stl.toml:3: scale: expected a number from 0.000001"},
      {"scale = nan\n", "a.stl.toml:1: scale: expected"},
      {"copies = 0\n", "a.stl.toml:1: copies: expected an integer from 1 to 1000"},
      {"copies = 2.5\n", "a.stl.toml:1: copies: expected"},
      {"variant = \"best\"\n", "a.stl.toml:1: variant: expected one of packed"},
      {"no_split = 1\n", "a.stl.toml:1: no_split: expected true or false"},
      {"seed = -1\n", "a.stl.toml:1: seed: expected an integer from 0 up"},
      {"size = 1\nscale = 2\n", "a.stl.toml:2: there cannot be both size and scale"},
      {"sise = 1\n", "a.stl.toml:1: unknown key sise"},
      {"set = 1\n", "a.stl.toml:1: set: expected a table"},
      {"[set]\ngap = 1\n", "a.stl.toml:2: set: There is no key \"gap\""},
      {"[set]\n\ngap_mm = -1\n", "a.stl.toml:3: set: gap_mm: expected"},
      {"[set]\ngap_mm = [[1]]\n", "a.stl.toml:2: set.gap_mm: expected"},
      {"[set]\ngap_mm = 1979-05-27\n", "a.stl.toml:2: set.gap_mm: expected"},
      {"[set]\ndialect = \"usb\"\n", "a.stl.toml:2: set.dialect is the printer's"},
      {"[set.link]\nsafe_gcode = \"M140 S100\"\n", "a.stl.toml:2: set.link.safe_gcode is the"},
      {"[set\n", "a.stl.toml:1: "},
      {std::string(70000, '#'), "larger than 64 KiB"},
  };
  for (const auto& [text, expected] : cases)
    EXPECT_THAT(refusal(text), HasSubstr(expected)) << text;
}

TEST_F(ModelOptionsTest, LinksAreNotFollowed) {
  const fs::path link = folder_.path() / "b.stl.toml";
  fs::create_symlink("/etc/passwd", link);
  EXPECT_FALSE(has_settings_beside(folder_.path() / "b.stl"));
  try {
    read_model_settings(link, read_profile("marlin"));
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()).find("root"), std::string::npos);
  }
}

TEST_F(ModelOptionsTest, TheModelsSettingsCountOverThePrinters) {
  ModelOptions printer;
  printer.size_mm = 60;
  printer.hollow = false;
  printer.variant = "solid";
  printer.set = {"gap_mm=1"};
  EXPECT_THAT(
      arguments_of(laid_over(printer, read("scale = 2\nno_hollow = false\n[set]\ngap_mm = 3"))),
      ElementsAre("--scale", "2", "--variant", "solid", "--set", "gap_mm=1", "--set", "gap_mm=3"));
  EXPECT_EQ(laid_over(printer, ModelOptions{}), printer);
}

TEST_F(ModelOptionsTest, NoTextMakesItThrowAnythingElse) {
  EXPECT_TRUE(rc::check([this](const std::string& text) {
    try {
      read(text);
    } catch (const Error& error) {
      RC_ASSERT(error.fault() == Fault::kBadProfile);
    }
  }));
}

TEST_F(ModelOptionsTest, TheManualNamesEveryKey) {
  const char* source = std::getenv("PACKMERGER_SOURCE");
  if (source == nullptr) GTEST_SKIP() << "PACKMERGER_SOURCE is not set; run it with ctest";
  std::ifstream file(fs::path(source) / "docs/DAEMON.md");
  std::stringstream text;
  text << file.rdbuf();
  for (const DaemonKey& key : model_settings_keys())
    EXPECT_THAT(text.str(), HasSubstr("| `" + key.name + "` | " + key.expected)) << key.name;
}

}  // namespace
}  // namespace packmerger
