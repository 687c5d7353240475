// job.json holds every key of its contract, with the right type.
#include "tray/job_json.h"

#include <gtest/gtest.h>

#include <fstream>

#include "base/files.h"
#include "model/files/job_folder_names.h"
#include "tray/known_ways.h"
#include "unit/tray/sample_job.h"

namespace packmerger {
namespace {

using Json = nlohmann::json;

// A letter a type: s text, n number, i integer, b bool, a array, o object, z null.
std::string type_of(const Json& value) {
  if (value.is_string()) return "s";
  if (value.is_number_integer()) return "i";
  if (value.is_number()) return "n";
  if (value.is_boolean()) return "b";
  if (value.is_array()) return "a";
  if (value.is_object()) return "o";
  return "z";
}

void expect_keys(const Json& object, const std::map<std::string, std::string>& types,
                 const std::string& where) {
  ASSERT_TRUE(object.is_object()) << where;
  for (const auto& [key, type] : types) {
    ASSERT_TRUE(object.contains(key)) << where << "." << key;
    EXPECT_EQ(type_of(object[key]), type) << where << "." << key;
  }
}

const std::map<std::string, std::string> kEstimate = {
    {"fits", "b"},          {"time_s", "n"},       {"model_mm3", "n"},    {"model_g", "n"},
    {"support_mm3", "n"},   {"support_g", "n"},    {"cost", "n"},         {"currency", "s"},
    {"parts", "i"},         {"trays", "i"},        {"assembly_min", "n"}, {"source", "s"},
    {"material_cost", "n"}, {"machine_cost", "n"}, {"hands_cost", "n"}};

TEST(JobJson, HasEveryKeyOfTheContract) {
  const Json json = job_json(fixtures::sample_job());
  expect_keys(json,
              {{"version", "i"},
               {"inputs", "a"},
               {"profile", "o"},
               {"seed", "i"},
               {"settings", "o"},
               {"printer", "o"},
               {"shell", "o"},
               {"segments", "o"},
               {"packing", "o"},
               {"parts", "a"},
               {"removal_order", "a"},
               {"estimates", "o"},
               {"advice", "o"},
               {"timings_s", "o"},
               {"warnings", "a"},
               {"variant", "s"}},
              "job");
  EXPECT_EQ(json["version"], 1);
  for (const Json& input : json["inputs"])
    expect_keys(input, {{"file", "s"}, {"sha256", "s"}, {"scale", "n"}}, "inputs");
  expect_keys(json["profile"], {{"id", "s"}, {"sha256", "s"}}, "profile");
  expect_keys(
      json["printer"],
      {{"build_mm", "a"}, {"plate_mm", "a"}, {"keep_out_mm", "a"}, {"support_angle_deg", "n"}},
      "printer");
  expect_keys(json["shell"], {{"volume_mm3", "n"}, {"wall_mm", "n"}}, "shell");
  expect_keys(json["segments"],
              {{"tetrahedra", "i"}, {"clusters", "i"}, {"after_premerge", "i"}, {"final", "i"}},
              "segments");
  expect_keys(json["packing"],
              {{"weight", "n"},
               {"cost", "n"},
               {"bbox_mm3", "n"},
               {"support_mm3", "n"},
               {"height_mm", "n"},
               {"gap_mm", "n"},
               {"grid_mm", "n"}},
              "packing");
  for (const Json& part : json["parts"]) {
    expect_keys(part,
                {{"id", "i"},
                 {"model", "i"},
                 {"tray", "i"},
                 {"file", "s"},
                 {"volume_mm3", "n"},
                 {"transform", "a"},
                 {"neighbours", "a"}},
                "parts");
    EXPECT_EQ(part["transform"].size(), 16U);
    for (const Json& neighbour : part["neighbours"])
      expect_keys(neighbour, {{"id", "i"}, {"glue_area_mm2", "n"}}, "neighbours");
  }
  expect_keys(json["settings"],
              {{"technology", "s"},
               {"build_mm", "a"},
               {"layer_mm", "n"},
               {"support_angle_deg", "n"},
               {"gap_mm", "n"},
               {"grid_mm", "n"},
               {"rotation_step_deg", "n"},
               {"objective", "s"},
               {"weight", "n"},
               {"wall_mm", "n"},
               {"voxel_mm", "n"},
               {"segmentation", "s"},
               {"clusters", "i"},
               {"min_glue_area_mm2", "n"},
               {"min_volume_fraction", "n"},
               {"tabu_memory", "i"},
               {"tabu_patience", "i"}},
              "settings");
  for (const Json& warning : json["warnings"])
    expect_keys(warning, {{"code", "s"}, {"text", "s"}}, "warnings");
}

TEST(JobJson, SettingsRepeatEveryKeyAboveTheTables) {
  const Json settings = job_json(fixtures::sample_job())["settings"];
  for (const ProfileKey& key : profile_keys())
    if (key.name.find('.') == std::string::npos && key.name != "id" && key.name != "name") {
      EXPECT_TRUE(settings.contains(key.name)) << key.name;
    }
}

TEST(JobJson, SaysWhereItDoesNotFit) {
  const Json estimates = job_json(fixtures::sample_job())["estimates"];
  expect_keys(estimates["packed"], kEstimate, "packed");
  expect_keys(estimates["solid"], kEstimate, "solid");
  EXPECT_EQ(estimates["solid"]["source"], "slicer");
  EXPECT_EQ(estimates["packed"]["source"], "model");
  for (const char* missing : {"as_is", "hollow"}) {
    EXPECT_EQ(estimates[missing]["fits"], false);
    EXPECT_EQ(estimates[missing].size(), kEstimate.size());
    for (const auto& [key, value] : estimates[missing].items())
      if (key != "fits") {
        EXPECT_TRUE(value.is_null()) << key;
      }
  }
}

TEST(JobJson, TransformsAreRowMajorAndInvertible) {
  const Job job = fixtures::sample_job();
  const Json json = job_json(job);
  for (std::size_t i = 0; i < job.parts.size(); ++i) {
    const Json& numbers = json["parts"][i]["transform"];
    Eigen::Matrix4d matrix;
    for (int k = 0; k < 16; ++k) matrix(k / 4, k % 4) = numbers[static_cast<std::size_t>(k)];
    EXPECT_EQ(matrix.row(3), Eigen::RowVector4d(0, 0, 0, 1));
    const Vec3 point(3, -2, 7);
    const Vec3 placed = (matrix * point.homogeneous()).head<3>();
    EXPECT_EQ(placed, job.parts[i].pose * point);
  }
}

TEST(JobJson, OptionalKeysAreThereOnlyWhereTheySaySomething) {
  Job job = fixtures::sample_job();
  Json json = job_json(job);
  EXPECT_FALSE(json.contains("removal_path"));
  EXPECT_FALSE(json.contains("resample_tolerance_mm"));
  job.removal_paths[3] = {{0, 0, 5}, {2, 0, 5}};
  job.resample_tolerance_mm = 0.3;
  json = job_json(job);
  EXPECT_EQ(json["removal_path"]["3"], Json::parse("[[0.0,0.0,5.0],[2.0,0.0,5.0]]"));
  EXPECT_EQ(json["resample_tolerance_mm"], 0.3);
}

TEST(KnownWays, AreReadBackAsTheyWereWritten) {
  Job job = fixtures::sample_job();
  job.compared = {std::string(64, 'c'), {{"sealed_cavity", "It traps support."}}, true, false};
  job.estimates.solid = Estimate{};
  job.estimates.solid->cost = 1.0 / 3;
  job.clusters = 40;
  job.resample_tolerance_mm = 0.3;
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "job.json";
  write_file_whole(file, report_text(job_json(job)));
  const std::optional<KnownWays> known = known_ways(folder.path());
  ASSERT_TRUE(known);
  EXPECT_EQ(compared_json(known->compared), compared_json(job.compared));
  EXPECT_EQ(comparison_json(known->estimates), comparison_json(job.estimates));
  EXPECT_EQ(known->clusters, 40);
  EXPECT_EQ(known->resample_tolerance_mm, 0.3);
}

TEST(KnownWays, AreNoneWhereTheyCannotBeRead) {
  const TemporaryFolder folder;
  EXPECT_FALSE(known_ways(folder.path()));
  Json json = job_json(fixtures::sample_job());
  for (const char* key : {"compared", "segments", "estimates"}) {
    Json wrong = json;
    wrong[key] = {{"packed", 7}};
    write_file_whole(folder.path() / "job.json", report_text(wrong));
    EXPECT_FALSE(known_ways(folder.path())) << key;
  }
  json.erase("compared");  // as an earlier version wrote it
  for (const std::string& text : {report_text(json), std::string("{"), std::string("[1]")}) {
    write_file_whole(folder.path() / "job.json", text);
    EXPECT_FALSE(known_ways(folder.path())) << text;
  }
}

TEST(JobJson, NamesThatAreNotUtf8DoNotStopIt) {
  Job job = fixtures::sample_job();
  job.inputs[0].file = "caf\xe9.stl";
  const Json again = Json::parse(report_text(job_json(job)));
  EXPECT_EQ(again["inputs"][0]["file"], "caf\xef\xbf\xbd.stl");
}

TEST(JobJson, FilesOfTraysAndPartsAreNumbered) {
  EXPECT_EQ(tray_file("tray", 1, "stl"), "tray.stl");
  EXPECT_EQ(tray_file("tray", 2, "3mf"), "tray-2.3mf");
  EXPECT_EQ(tray_file("program", 12, "x3g"), "program-12.x3g");
  EXPECT_EQ(part_file(1), "parts/01.stl");
  EXPECT_EQ(part_file(100), "parts/100.stl");
}

}  // namespace
}  // namespace packmerger
