// packmerger-bench figures, run as a user runs it.
#include <gtest/gtest.h>

#include <cstdlib>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "base/files.h"
#include "base/process/process.h"

namespace packmerger::bench {
namespace {

using Json = nlohmann::json;

ProcessResult figures(const std::vector<std::string>& arguments) {
  const char* folder = std::getenv("PACKMERGER_BIN");
  ProcessSpec spec;
  spec.argv = {std::string(folder != nullptr ? folder : "build/bin") + "/packmerger-bench",
               "figures"};
  spec.argv.insert(spec.argv.end(), arguments.begin(), arguments.end());
  return run_process(spec, 0, Progress());
}

std::string text_of(const fs::path& path) { return read_file(path, 50'000'000); }

TEST(Figures, WeightWritesDataPlotPicturesAndJobs) {
  const TemporaryFolder folder;
  const fs::path out = folder.path() / "figures";
  const ProcessResult result =
      figures({"--only", "fig5", "--budget", "0.5", "--out", out.string()});
  ASSERT_TRUE(result.status.ok()) << result.err;
  const Json packings = Json::parse(text_of(out / "fig5.json"))["packings"];
  ASSERT_EQ(packings.size(), 3U);
  const std::string plot = text_of(out / "fig5.svg");
  const std::vector<std::string> names{"0", "0.5", "1"};
  for (std::size_t i = 0; i < 3; ++i) {
    const Json& packing = packings[i];
    const double weight = std::stod(names[i]);
    EXPECT_EQ(packing["weight"], weight);
    const Json job = Json::parse(text_of(out / "jobs" / ("fig5_w" + names[i]) / "job.json"));
    EXPECT_EQ(job["settings"]["weight"], weight);
    for (const char* key : {"bbox_mm3", "support_mm3", "cost"})
      EXPECT_NEAR(packing[key], job["packing"][key], 1e-6 * packing[key].get<double>()) << key;
    EXPECT_NEAR(packing["cost"].get<double>(),
                weight * packing["bbox_mm3"].get<double>() +
                    (1 - weight) * packing["support_mm3"].get<double>(),
                1e-6 * packing["cost"].get<double>());
    EXPECT_EQ(packing["parts"], job["parts"].size());
    EXPECT_NE(plot.find(">w = " + names[i] + "<"), std::string::npos);
    const std::string picture = text_of(out / ("fig5_w" + names[i] + ".png"));
    EXPECT_EQ(picture.substr(1, 3), "PNG");
    EXPECT_GT(picture.size(), 10'000U);
  }
}

TEST(Figures, GroupRowTellsItsRatios) {
  const TemporaryFolder folder;
  // the second run replaces what the first one wrote
  ProcessResult result;
  for (int run = 0; run < 2; ++run) {
    result = figures(
        {"--only", "group_1", "--budget", "0.5", "--markdown", "--out", folder.path().string()});
    ASSERT_TRUE(result.status.ok()) << result.err;
  }
  const Json row = Json::parse(text_of(folder.path() / "fig13_group_1.json"));
  const Json job = Json::parse(text_of(folder.path() / "jobs" / "group_1" / "job.json"));
  const Json& packed = job["estimates"]["packed"];
  EXPECT_EQ(packed["source"], "slicer");
  EXPECT_NEAR(row["time_ratio"].get<double>(),
              packed["time_s"].get<double>() / job["estimates"]["as_is"]["time_s"].get<double>(),
              1e-6);
  // cups and crystals standing by themselves need no support to divide by
  EXPECT_EQ(job["estimates"]["as_is"]["support_g"], 0);
  EXPECT_TRUE(row["support_ratio"].is_null());
  EXPECT_NE(result.out.find("| group_1 | replicator | "), std::string::npos);
}

TEST(Figures, RefusesAnUnknownName) {
  const TemporaryFolder folder;
  const ProcessResult result = figures({"--only", "fig99", "--out", folder.path().string()});
  EXPECT_FALSE(result.status.ok());
  EXPECT_NE(result.err.find("fig99"), std::string::npos);
}

}  // namespace
}  // namespace packmerger::bench
