// What the table of docs/PACKING packs, how it checks and what it keeps.
#include <gtest/gtest.h>

#include <array>
#include <cstdlib>
#include <string>
#include <vector>

#include "base/files.h"
#include "base/process/process.h"
#include "bench/packing_table/functional_parts.h"
#include "bench/packing_table/hull_part.h"
#include "bench/packing_table/instances.h"
#include "bench/packing_table/kept_runs.h"
#include "bench/packing_table/paper_packer.h"
#include "bench/packing_table/summary.h"
#include "bench/packing_table/tray_check.h"
#include "bench/packing_table/tray_rows.h"
#include "fixtures/profiles.h"
#include "shape/surface/repair.h"
#include "unit/pack/shapes.h"

namespace packmerger::bench {
namespace {

using Json = nlohmann::ordered_json;

double sum_of_volumes(const std::vector<PackItem>& items) {
  double sum = 0;
  for (const PackItem& item : items) sum += item.volume_mm3;
  return sum;
}

// Pieces and handles by Euler's formula: V - E + F of all.
int euler(const Mesh& mesh) {
  const auto faces = static_cast<int>(mesh.n_triangles());
  return static_cast<int>(mesh.n_points()) - 3 * faces / 2 + faces;
}

TEST(FunctionalParts, AreClosedAndOfTheStatedSizes) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    const std::vector<PackItem> items = functional_items(seed);
    ASSERT_EQ(items.size(), 60U);
    EXPECT_NEAR(sum_of_volumes(items), 351e3, 4e3);
    for (const PackItem& item : items) {
      EXPECT_TRUE(item.surface.is_closed());
      EXPECT_FALSE(self_intersects(item.surface)) << seed << " " << item.model;
      EXPECT_GT(item.volume_mm3, 0);
      EXPECT_NEAR(item.volume_mm3, volume_mm3(item.surface), 1e-9 * item.volume_mm3);
      const double longest = bounding_box(item.surface).sizes().maxCoeff();
      EXPECT_GE(longest, 15) << seed << " " << item.model;
      EXPECT_LE(longest, 60) << seed << " " << item.model;
    }
  }
}

TEST(FunctionalParts, AreAnotherSetForAnotherSeedAndTheSameForTheSame) {
  const auto first = functional_items(1), again = functional_items(1), other = functional_items(2);
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(first[i].surface.points(), again[i].surface.points());
    EXPECT_NE(first[i].volume_mm3, other[i].volume_mm3);
  }
}

TEST(HullPart, IsOneClosedBodyOfTheStatedSize) {
  const Mesh hull = hull_part();
  EXPECT_TRUE(hull.is_closed());
  EXPECT_FALSE(self_intersects(hull));
  const Vec3 size = bounding_box(hull).sizes();
  EXPECT_NEAR(size.x(), 60, 1e-9);
  EXPECT_NEAR(size.y(), 31, 1e-9);
  EXPECT_NEAR(size.z(), 48, 1e-9);
  EXPECT_NEAR(volume_mm3(hull), 15500, 100);
  // Two windows and a door make two handles: the cabin's room is one with what is outside.
  EXPECT_EQ(euler(hull), 2 - 2 * 2);
}

TEST(PlannedDivision, IsByClustersWhereNoPlanesDivide) {
  Profile profile = fixtures::shipped_profile("objet30");
  profile.shape.voxel_mm = 2;              // fewer tetrahedra
  profile.shape.min_glue_area_mm2 = 1000;  // no cut through the shell is as large
  EXPECT_GE(planned_division(shapes::sphere(15, 24), profile)->segments.count, 1);
}

PackProblem two_boxes(double gap_mm) {
  std::vector<PackItem> items;
  for (const double height : {10.0, 6.0}) {
    PackItem item;
    item.surface = shapes::box({10, 10, height});
    item.volume_mm3 = volume_mm3(item.surface);
    item.model = static_cast<int>(items.size());
    items.push_back(item);
  }
  return height_problem(items, {30, 20, 40}, gap_mm);
}

Packing beside(double distance_mm) {
  Packing packing;
  for (const int i : {0, 1}) {
    PlacedPart part;
    part.items = {i};
    part.pose.translation() = Vec3(i * (10 + distance_mm), 0, 0);
    packing.parts.push_back(part);
  }
  packing.removal_order = {1, 0};
  packing.removal_paths.resize(2);
  return packing;
}

TEST(TrayCheck, CountsDensityOverTheBase) {
  const TrayCheck check = check_packing(two_boxes(1), beside(1.05));
  EXPECT_TRUE(check.broken.empty());
  EXPECT_NEAR(check.height_mm, 10, 1e-12);
  EXPECT_NEAR(check.density, 1600.0 / (30 * 20 * 10), 1e-12);
  EXPECT_NEAR(check.apart_mm, 1.05, 1e-9);
  EXPECT_EQ(check.straight_up, 2);
}

TEST(TrayCheck, TellsWhatDoesNotHold) {
  EXPECT_EQ(check_packing(two_boxes(1), beside(0.9)).broken.size(), 1U);
  EXPECT_FALSE(check_packing(two_boxes(0), beside(-0.5)).broken.empty());
  EXPECT_EQ(check_packing(two_boxes(0), beside(10.5)).broken.size(), 1U);  // out of the box
  Packing caught = beside(0);
  caught.parts[1].pose.translation() = Vec3(0, 0, 10.5);
  EXPECT_TRUE(check_packing(two_boxes(0), caught).broken.empty());
  caught.removal_order = {0, 1};
  EXPECT_EQ(check_packing(two_boxes(0), caught).broken.size(), 1U);
  Packing lost = beside(1);
  lost.parts.pop_back();
  lost.removal_paths.pop_back();
  lost.removal_order = {0};
  EXPECT_FALSE(check_packing(two_boxes(0), lost).broken.empty());
}

TEST(PaperPacker, IsApartOnTheMeshesWhereItsSamplesAreNot) {
  // spheres and cubes of sizes that no cell divides
  std::vector<PackItem> items;
  for (int i = 0; i < 6; ++i) {
    PackItem item;
    item.surface = i % 2 == 0 ? shapes::sphere(5.3, 12) : shapes::box(Vec3::Constant(7.6));
    item.volume_mm3 = volume_mm3(item.surface);
    item.model = i;
    items.push_back(item);
  }
  const PackProblem problem = height_problem(items, {24, 20, 60}, 0);
  const ApartAnswer apart = paper_apart(problem, 0.1, 1);
  EXPECT_TRUE(check_packing(problem, apart.packing).broken.empty());
  EXPECT_GT(apart.packings, 0);
  EXPECT_GT(paper_sampled(problem, 0.1, 1).cost, 0);
}

TEST(TableRow, TellsATinyTrayWithItsCheck) {
  const TemporaryFolder folder;
  const Json run = height_run("tiny", two_boxes(1), false, 0, {{1, 2}, folder.path()});
  EXPECT_NEAR(run["figures"]["height_mm"].get<double>(), 10, 0.5);
  EXPECT_TRUE(run["check"]["broken"].empty()) << run.dump();
  EXPECT_GE(run["check"]["apart_mm"].get<double>(), 1 - 1e-6);
  EXPECT_TRUE(fs::exists(folder.path() / "tiny.1.2.tray_1.stl"));
}

TEST(Summary, TellsMedianAndRange) {
  EXPECT_EQ(median({3, 1, 2}), 2);
  EXPECT_EQ(median({4, 1, 2, 3}), 2.5);
  std::vector<Json> runs;
  for (const double height : {44.0, 42.0, 47.5})
    runs.push_back({{"figures", {{"height_mm", height}}},
                    {"seconds", 60.0},
                    {"processor_s", 59.0},
                    {"check",
                     {{"apart_mm", height / 100},
                      {"outside_mm", 0},
                      {"straight_up", 20},
                      {"by_path", 1},
                      {"broken", Json::array()}}}});
  EXPECT_EQ(figures_text(runs), "height 44.00 mm (42.00–47.50)");
  EXPECT_EQ(check_text(runs), "0.4200 mm apart, 60 straight up, 3 by a path");
  TableCase of;
  of.row = of.packer = of.what = "a";
  const std::string table = packing_table_markdown(
      Json::array({case_json(of, runs, ""), case_json(of, {}, "skipped: b")}));
  EXPECT_NE(table.find("| a | a | height 44.00 mm (42.00–47.50) | 3 | 60 | 59 |"),
            std::string::npos);
  EXPECT_NE(table.find("skipped: b"), std::string::npos);
}

void git(const fs::path& folder, const std::vector<std::string>& arguments) {
  ProcessSpec spec;
  spec.argv = {"git", "-C", folder.string(), "-c", "user.name=a", "-c", "user.email=a@b"};
  spec.argv.insert(spec.argv.end(), arguments.begin(), arguments.end());
  ASSERT_TRUE(run_process(spec, 60, Progress()).status.ok());
}

TEST(KeptRuns, HoldForACommitWithoutChangesAlone) {
  if (!program_in_path("git")) GTEST_SKIP() << "git is not installed";
  const TemporaryFolder tree, kept;
  EXPECT_FALSE(measured_for(tree.path()));
  git(tree.path(), {"init", "-q"});
  write_file_whole(tree.path() / "a.txt", "a");
  git(tree.path(), {"add", "."});
  git(tree.path(), {"commit", "-qm", "a"});
  const auto first = measured_for(tree.path());
  ASSERT_TRUE(first);
  const Seeds seeds{1, 2};
  const Json run{{"figures", {{"height_mm", 42.5}}}};
  KeptRuns(kept.path() / "runs", first).keep("mixed-10", "drop", seeds, run);

  const KeptRuns again(kept.path() / "runs", measured_for(tree.path()));
  EXPECT_EQ(again.find("mixed-10", "drop", seeds), run);
  EXPECT_FALSE(again.find("mixed-10", "drop", {2, 2}));
  EXPECT_FALSE(again.find("mixed-10", "drop", {1, 1}));
  EXPECT_FALSE(again.find("mixed-10", "anywhere", seeds));

  write_file_whole(tree.path() / "a.txt", "b");
  EXPECT_FALSE(measured_for(tree.path()));
  const KeptRuns dirty(kept.path() / "runs", std::nullopt);
  EXPECT_FALSE(dirty.find("mixed-10", "drop", seeds));
  dirty.keep("mixed-60", "drop", seeds, run);
  EXPECT_FALSE(again.find("mixed-60", "drop", seeds));

  git(tree.path(), {"commit", "-qam", "b"});
  const KeptRuns other(kept.path() / "runs", measured_for(tree.path()));
  EXPECT_FALSE(other.find("mixed-10", "drop", seeds));

  // what was cut short or spoiled is measured anew
  write_file_whole(kept.path() / "runs" / "mixed-10.drop.1.2.json", "{\"measured");
  EXPECT_FALSE(again.find("mixed-10", "drop", seeds));
}

}  // namespace
}  // namespace packmerger::bench
