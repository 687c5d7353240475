// The packer's promises, as an opponent would test them.
#include "pack/pack.h"

#include <atomic>
#include <chrono>

#include <gtest/gtest.h>

#include <rapidcheck/gtest.h>

#include "base/parallel.h"
#include "base/random.h"
#include "pack/exact/exact_gap.h"
#include "unit/pack/check.h"
#include "unit/pack/problems.h"

namespace packmerger {
namespace {

using shapes::problem_of;

Mesh random_shape(Random& random) {
  const auto size = [&random](double low, double high) {
    return low + (high - low) * random.unit();
  };
  Mesh mesh;
  switch (random.below(5)) {
    case 0:
      mesh = shapes::box(Vec3(size(2, 25), size(2, 25), size(2, 25)));
      break;
    case 1:
      mesh = shapes::tetrahedron(size(5, 30));
      break;
    case 2:
      mesh = shapes::l_shape(size(12, 25), size(2, 6), size(3, 20));
      break;
    case 3:
      mesh = shapes::cup(size(6, 14), size(5, 25), size(1.5, 3), 12);
      break;
    default:
      mesh = shapes::bowl(size(8, 16), size(1, 3), 12);
      break;
  }
  // Models lie anywhere and any way round in their files.
  Pose pose = Pose::Identity();
  const Vec3 axis(random.unit() - 0.5, random.unit() - 0.5, random.unit() - 0.5);
  if (random.below(2) == 0)
    pose.linear() =
        Eigen::AngleAxisd(size(0, 6), (axis + Vec3(0, 0, 1e-3)).normalized()).toRotationMatrix();
  pose.translation() = 200 * axis;
  return transformed(mesh, pose);
}

PackProblem random_problem(Random& random) {
  std::vector<Mesh> meshes;
  const std::size_t count = 2 + random.below(5);
  for (std::size_t i = 0; i < count; ++i) meshes.push_back(random_shape(random));
  PackProblem problem = problem_of(std::move(meshes), Vec3(60, 55, 50));
  constexpr std::array<double, 4> kGaps{0, 0.5, 1, 2.3};
  constexpr std::array<double, 3> kGrids{1, 0.7, 2};
  problem.gap_mm = kGaps[random.below(4)];
  problem.grid_mm = kGrids[random.below(3)];
  problem.rotation_step = radians(random.below(2) == 0 ? 90 : 45);
  problem.support_angle = radians(random.below(2) == 0 ? 0 : 45);
  problem.cost = shapes::paper_cost(0.25 * static_cast<double>(random.below(5)));
  problem.seed = random.bits();
  return problem;
}

RC_GTEST_PROP(Pack, KeepsEveryPromiseForRandomParts, (std::uint64_t seed)) {
  Random random(seed);
  const PackProblem problem = random_problem(random);
  const Packing packing = pack(problem, {});
  check::expect_valid(problem, packing, 0.5);
  RC_ASSERT(!::testing::Test::HasFailure());
  for (int tray = 0; tray < static_cast<int>(packing.trays.size()); ++tray) {
    std::vector<Mesh> meshes;
    for (const PlacedPart& part : packing.parts)
      if (part.tray == tray)
        meshes.push_back(transformed(
            problem.items[static_cast<std::size_t>(part.items.front())].surface, part.pose));
    RC_ASSERT(least_gap_mm(meshes) >= problem.gap_mm - 1e-5);
  }
}

// Without a gap, a step while settling once led a rim past another part's edge.
TEST(Pack, NothingSinksPastWhatStandsOut) {
  Random random(1873815);
  const PackProblem problem = random_problem(random);
  EXPECT_EQ(problem.gap_mm, 0);
  check::expect_valid(problem, pack(problem, {}), 0.5);
}

void expect_same(const Packing& a, const Packing& b) {
  ASSERT_EQ(a.parts.size(), b.parts.size());
  EXPECT_EQ(a.cost, b.cost);
  EXPECT_EQ(a.removal_order, b.removal_order);
  for (std::size_t i = 0; i < a.parts.size(); ++i) {
    EXPECT_EQ(a.parts[i].items, b.parts[i].items);
    EXPECT_EQ(a.parts[i].tray, b.parts[i].tray);
    EXPECT_EQ(a.parts[i].pose.matrix(), b.parts[i].pose.matrix());
  }
}

// Six patches of a spherical shell and the edges between neighbours.
PackProblem sphere_problem(double radius) {
  PackProblem problem;
  for (int face = 0; face < 6; ++face) {
    PackItem item;
    item.surface = shapes::sphere_patch(radius, 3, face, 10);
    item.volume_mm3 = volume_mm3(item.surface);
    problem.items.push_back(std::move(item));
    for (int other = 0; other < face; ++other)
      if (other / 2 != face / 2) problem.edges.push_back({other, face, 200});
  }
  problem.build_mm = Vec3(294, 192, 148.6);
  problem.rotation_step = radians(30);
  problem.cost = shapes::paper_cost();
  return problem;
}

TEST(Pack, SameAnswerOnOneThreadAndOnTwoAndForTheSameSeed) {
  PackProblem problem = sphere_problem(20);
  problem.tabu_patience = 3;
  problem.seed = 7;
  const Packing first = pack(problem, {});
  const Packing second = pack(problem, {});
  expect_same(first, second);
  const ThreadLimit one(1);
  expect_same(first, pack(problem, {}));
}

TEST(Pack, SegmentsOfASphereNestAndKeepEveryPromise) {
  PackProblem problem = sphere_problem(50);
  problem.rotation_step = radians(90);
  const Packing packing = pack(problem, {});
  check::expect_valid(problem, packing, 1);
  ASSERT_EQ(packing.trays.size(), 1U);
  std::vector<Mesh> meshes;
  for (const PlacedPart& part : packing.parts) {
    std::vector<const Mesh*> members;
    for (const int item : part.items)
      members.push_back(&problem.items[static_cast<std::size_t>(item)].surface);
    meshes.push_back(transformed(*members.front(), part.pose));
  }
  EXPECT_GE(least_gap_mm(meshes), problem.gap_mm - 1e-6);
  // Alone, each patch stands in a box of about 68 × 68 × 24 mm; six of them nested take far less
  // than six times that.
  EXPECT_LT(packing.trays[0].size_mm.prod(), 0.75 * 6 * 68 * 68 * 24);
}

TEST(Pack, BowlsStandInEachOther) {
  std::vector<Mesh> bowls;
  for (int i = 0; i < 4; ++i) bowls.push_back(shapes::bowl(20, 2, 36));
  PackProblem problem = problem_of(std::move(bowls), Vec3(42, 42, 60));
  problem.cost.evaluate = [](const TrayMeasure& m) { return m.size_mm.z(); };
  problem.cost.lower_bound = problem.cost.evaluate;
  const Packing packing = pack(problem, {});
  check::expect_valid(problem, packing, 0.5);
  ASSERT_EQ(packing.trays.size(), 1U);  // only nested do they fit at all
  const double alone = bounding_box(problem.items[0].surface).sizes().z();
  EXPECT_LT(packing.trays[0].size_mm.z(), 0.75 * (4 * alone + 3 * problem.gap_mm));
}

TEST(Pack, MorePartsThanFitGoToFurtherTrays) {
  std::vector<Mesh> boxes(7, shapes::box(Vec3(30, 30, 30)));
  const PackProblem problem = problem_of(std::move(boxes), Vec3(62, 62, 32));
  const Packing packing = pack(problem, {});
  check::expect_valid(problem, packing, 0.5);
  EXPECT_EQ(packing.trays.size(), 2U);
}

TEST(Pack, FewTraysComeBeforeLittleCost) {
  // On two trays they need no support at all; five of them fit one, in two layers.
  PackProblem problem =
      problem_of(std::vector<Mesh>(5, shapes::box(Vec3(30, 30, 30))), Vec3(62, 62, 64));
  problem.cost = shapes::paper_cost(0);
  const Packing packing = pack(problem, {});
  check::expect_valid(problem, packing, 0.5);
  EXPECT_EQ(packing.trays.size(), 1U);
}

TEST(Pack, NestedShellsComeAsCloseAsTheirShapesAllow) {
  std::vector<Mesh> patches;
  for (int face = 0; face < 3; ++face) patches.push_back(shapes::sphere_patch(50, 3, face, 12));
  PackProblem problem = problem_of(std::move(patches), Vec3(72, 72, 200));
  problem.gap_mm = 0;
  problem.cost.evaluate = [](const TrayMeasure& m) { return m.size_mm.z(); };
  problem.cost.lower_bound = problem.cost.evaluate;
  const Packing packing = pack(problem, {});
  check::expect_valid(problem, packing, 0.5);
  // Spheres of 50 and 47 mm meet at a patch's corners, 47 / √3 along the axis.
  const double corner = 47 / std::sqrt(3.0);
  const double spacing = std::sqrt(corner * corner + 50 * 50 - 47 * 47) - corner;
  EXPECT_LT(packing.cost, 1.01 * (50 - corner + 2 * spacing));
}

TEST(Pack, ManyPartsOfFewShapesFillSeveralTrays) {
  std::vector<Mesh> meshes;
  for (int i = 0; i < 60; ++i)
    meshes.push_back(i % 2 == 0 ? shapes::box(Vec3(9, 9, 9)) : shapes::l_shape(12, 3, 5));
  PackProblem problem = problem_of(std::move(meshes), Vec3(45, 45, 15));
  problem.tabu_patience = 1;
  const Packing packing = pack(problem, {});
  check::expect_valid(problem, packing, 0.5);
  // 16 of the boxes would fill a tray by themselves.
  EXPECT_GE(packing.trays.size(), 2U);
  EXPECT_LE(packing.trays.size(), 5U);
}

TEST(Pack, PartsAsLargeAsTheTrayGetOneEach) {
  std::vector<Mesh> meshes{shapes::box(Vec3(50, 40, 30), Vec3(0.3, 0.4, 0.1)),
                           shapes::box(Vec3(50, 40, 30), Vec3(-7.7, 0, 0)),
                           shapes::box(Vec3(5, 5, 5))};
  const PackProblem problem = problem_of(std::move(meshes), Vec3(50, 40, 30));
  const Packing packing = pack(problem, {});
  check::expect_valid(problem, packing, 0.5);
  EXPECT_EQ(packing.trays.size(), 3U);
}

TEST(Pack, APartThatFitsAslantOnlyIsTurned) {
  // 66 mm long in a 50 × 50 mm tray whose diagonal is 70.7 mm; 90° steps alone would refuse it.
  const PackProblem problem = problem_of({shapes::box(Vec3(66, 2, 2))}, Vec3(50, 50, 10));
  check::expect_valid(problem, pack(problem, {}), 0.5);
}

TEST(Pack, APartThatFitsNoTrayIsRefusedWithItsSize) {
  const PackProblem problem =
      problem_of({shapes::box(Vec3(5, 5, 5)), shapes::box(Vec3(80, 60, 20))}, Vec3(50, 50, 50));
  try {
    pack(problem, {});
    FAIL() << "was packed";
  } catch (const Error& error) {
    EXPECT_EQ(error.fault(), Fault::kBadInput);
    EXPECT_NE(std::string(error.what()).find("80.0 × 60.0 × 20.0"), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("model 2"), std::string::npos);
    EXPECT_FALSE(error.hint().empty());
  }
}

TEST(Pack, SettingsWithoutSenseAreRefused) {
  const auto refused = [](auto change, Fault fault = Fault::kUsage) {
    PackProblem problem = problem_of({shapes::box(Vec3(5, 5, 5))}, Vec3(50, 50, 50));
    change(problem);
    try {
      pack(problem, {});
    } catch (const Error& error) {
      return error.fault() == fault;
    }
    return false;
  };
  EXPECT_TRUE(refused([](PackProblem& p) { p.items.clear(); }));
  EXPECT_TRUE(refused([](PackProblem& p) { p.grid_mm = 0; }));
  EXPECT_TRUE(refused([](PackProblem& p) { p.grid_mm = 1e-6; }));
  EXPECT_TRUE(refused(
      [](PackProblem& p) {
        p.build_mm = Vec3(1, 1, 1);
        p.grid_mm = 1e-3;
        p.items[0].surface = shapes::box(Vec3(5, 5, 100));
      },
      Fault::kBadInput));
  EXPECT_TRUE(refused([](PackProblem& p) { p.gap_mm = -1; }));
  EXPECT_TRUE(refused([](PackProblem& p) { p.build_mm.z() = 0; }));
}

TEST(Pack, NotWorseThanSideBySide) {
  // Three flat plates: stacked they need support everywhere, with w = 0 side by side is free.
  PackProblem problem = problem_of(
      {shapes::box(Vec3(40, 30, 3)), shapes::box(Vec3(40, 30, 3)), shapes::box(Vec3(40, 30, 3))},
      Vec3(200, 200, 100));
  problem.cost = shapes::paper_cost(0);
  const Packing packing = pack(problem, {});
  check::expect_valid(problem, packing, 0.5);
  EXPECT_NEAR(packing.cost, 0, 1e-6);
}

TEST(Pack, MergesOnlyWhatMayBeMerged) {
  PackProblem problem =
      problem_of({shapes::box(Vec3(20, 20, 20)), shapes::box(Vec3(20, 20, 20), Vec3(20, 0, 0)),
                  shapes::box(Vec3(20, 20, 20), Vec3(40, 0, 0))},
                 Vec3(100, 100, 100));
  problem.items[0].model = problem.items[1].model = 0;
  problem.items[2].model = 1;
  problem.edges = {{0, 1, 400}, {1, 2, 400}};
  const Packing packing = pack(problem, {});
  // One block of 40 × 20 × 20 leaves no gap to fill; the third may not join it.
  ASSERT_EQ(packing.parts.size(), 2U);
  for (const PlacedPart& part : packing.parts)
    EXPECT_TRUE(part.items == std::vector<int>({0, 1}) || part.items == std::vector<int>({2}));
}

TEST(Pack, CanBeCancelledAndReportsProgress) {
  const PackProblem problem = sphere_problem(30);
  std::atomic<bool> cancelled = false;
  double last = -1;
  const Progress progress(
      [&](std::string_view stage, double fraction) {
        EXPECT_EQ(stage, "packing");
        EXPECT_GE(fraction, last);
        last = fraction;
        if (fraction > 0) cancelled = true;
      },
      &cancelled);
  try {
    pack(problem, progress);
    FAIL() << "was not interrupted";
  } catch (const Error& error) {
    EXPECT_EQ(error.fault(), Fault::kInterrupted);
  }
  EXPECT_GT(last, 0);
}

TEST(Pack, TheClockEndsTheSearch) {
  PackProblem problem = sphere_problem(20);
  problem.tabu_patience = 100000;
  problem.budget_s = 1;
  const auto start = std::chrono::steady_clock::now();
  const Packing packing = pack(problem, {});
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(40));
  check::expect_valid(problem, packing, 1);
}

}  // namespace
}  // namespace packmerger
