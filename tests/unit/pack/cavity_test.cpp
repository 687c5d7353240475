// Parts in cavities and under overhangs, and their ways out.

#include <gtest/gtest.h>

#include <rapidcheck/gtest.h>

#include "base/parallel.h"
#include "fixtures/block_solid.h"
#include "pack/anywhere/disassembly_order.h"
#include "pack/anywhere/escape_path.h"
#include "pack/exact/exact_gap.h"
#include "pack/pack.h"
#include "unit/pack/check.h"
#include "unit/pack/problems.h"

namespace packmerger {
namespace {

SolidGrid grid_of(const Vec3& build_mm, double gap_mm, double cell_mm = 0.5) {
  return {build_mm, cell_mm, 1.0 / 64, gap_mm, 0, true};
}

SolidPart drawn(const Mesh& mesh, const SolidGrid& grid) {
  std::vector<Vec3> points = mesh.points();
  const Vec3 low = bounding_box(mesh).min();
  for (Vec3& point : points) point -= low;
  return solid_part({mesh.with_points(points)}, grid);
}

Mesh upside_down(const Mesh& mesh) {
  return shapes::turned(mesh,
                        Eigen::AngleAxisd(std::numbers::pi, Vec3::UnitX()).toRotationMatrix());
}

// A box of 30 × 20 × 24 mm with walls of 2 mm, closed but for a square window of the given width in
// the wall at its right end.
Mesh box_with_window(double width) {
  const auto filled = [](int x, int y, int z) {
    const bool inner = y >= 1 && y <= 3 && z >= 1 && z <= 3;
    if (x == 1) return !inner;
    return x == 0 || y != 2 || z != 2;
  };
  return closed_mesh(fixtures::block_solid({0, 2, 28, 30},
                                           {0, 2, 10 - width / 2, 10 + width / 2, 18, 20},
                                           {0, 2, 3, 3 + width, 22, 24}, filled));
}

RC_GTEST_PROP(SolidPart, SpansHoldAllMatterAndLittleElse, (std::uint64_t seed)) {
  Random random(seed);
  Mesh mesh = shapes::random_solid(random);
  Pose pose = Pose::Identity();
  pose.translation() = -bounding_box(mesh).min() + Vec3(random.unit(), random.unit(), 0);
  mesh = transformed(mesh, pose);
  const SolidGrid grid = grid_of(Vec3(40, 40, 40), 0, 0.7);
  const SolidPart part = solid_part({mesh}, grid);
  const auto spans = [&](const Vec3& p) {
    return std::any_of(part.matter.begin(), part.matter.end(), [&](const SpanCell& cell) {
      return cell.x == static_cast<int>(p.x() / grid.cell_mm) &&
             cell.y == static_cast<int>(p.y() / grid.cell_mm) && cell.low * grid.unit_mm <= p.z() &&
             p.z() <= cell.high * grid.unit_mm;
    });
  };
  const Vec3 size = part.box.max();
  for (int i = 0; i < 300; ++i) {
    const Vec3 p = size.cwiseProduct(Vec3(random.unit(), random.unit(), random.unit()));
    if (check::is_inside(mesh, p)) RC_ASSERT(spans(p));
  }
  // Both ends of every span are heights of the surface somewhere over the cell.
  double volume = 0;
  for (const SpanCell& cell : part.centres)
    volume += (cell.high - cell.low) * grid.unit_mm * grid.cell_mm * grid.cell_mm;
  RC_ASSERT(std::abs(volume / volume_mm3(mesh) - 1) < 0.2);
  for (const SpanCell& cell : part.centres) {
    const Vec3 middle((cell.x + 0.5) * grid.cell_mm, (cell.y + 0.5) * grid.cell_mm,
                      (cell.low + cell.high) / 2.0 * grid.unit_mm);
    if (cell.high - cell.low <= 4) continue;
    // An emptiness thinner than a unit, where the line grazes an edge, is not told.
    const Vec3 unit(0, 0, grid.unit_mm);
    RC_ASSERT(check::is_inside(mesh, middle) ||
              (check::is_inside(mesh, middle - unit) && check::is_inside(mesh, middle + unit)));
  }
}

RC_GTEST_PROP(SolidTray, FreeHeightsKeepTheGap, (std::uint64_t seed)) {
  Random random(seed);
  const double gap = random.below(2) == 0 ? 0 : 0.8;
  const SolidGrid grid = grid_of(Vec3(40, 40, 60), gap, 0.7);
  const Mesh standing = shapes::random_solid(random);
  const Mesh moving = shapes::random_solid(random);
  const SolidPart one = drawn(standing, grid);
  const SolidPart other = drawn(moving, grid);
  const SolidPlace place{&one, 10, 10, 0};
  const SolidTray tray(grid, {place});
  const auto at = [&](const Mesh& mesh, int x, int y, int z) {
    Pose pose = Pose::Identity();
    pose.translation() =
        -bounding_box(mesh).min() + Vec3(x * grid.cell_mm, y * grid.cell_mm, z * grid.unit_mm);
    return transformed(mesh, pose);
  };
  for (int i = 0; i < 5; ++i) {
    const int x = static_cast<int>(random.below(20));
    const int y = static_cast<int>(random.below(20));
    for (const FreeHeights& free : tray.free_heights(other.reach, x, y))
      for (const int z : {free.low, free.high == kUpAndAway ? free.low + 100 : free.high})
        RC_ASSERT(least_gap_mm({at(standing, 10, 10, 0), at(moving, x, y, z)}) >= gap - 1e-6);
  }
}

// A cup over a ball must be lifted first, and the ball then goes up as well.
TEST(DisassemblyOrder, WhatStandsBelowSomethingComesOutAfterIt) {
  const SolidGrid grid = grid_of(Vec3(60, 60, 60), 1);
  const SolidPart cup = drawn(upside_down(shapes::cup(15, 25, 2)), grid);
  const SolidPart ball = drawn(shapes::sphere(6, 16), grid);
  const auto plan = disassembly_order(grid, {{&ball, 18, 18, 0}, {&cup, 0, 0, 0}});
  ASSERT_TRUE(plan);
  EXPECT_EQ(plan->order, (std::vector<int>{1, 0}));
  EXPECT_TRUE(plan->paths[0].empty());
  EXPECT_TRUE(plan->paths[1].empty());
}

// A block in a box leaves it by the window where that is large enough.
TEST(EscapePath, LeadsThroughAWindowThatIsLargeEnough) {
  const SolidGrid grid = grid_of(Vec3(80, 60, 60), 0.5);
  const SolidPart block = drawn(shapes::box(Vec3(6, 7, 8)), grid);
  for (const double window : {10.0, 7.5}) {
    const SolidPart house = drawn(box_with_window(window), grid);
    const SolidTray rest(grid, {{&house, 10, 10, 0}});
    const auto way = escape_path(rest, {&block, 20, 24, 200});
    ASSERT_EQ(way.has_value(), window > 8) << window;
    if (!way) continue;
    Vec3 end(0, 0, 0);
    for (const Vec3& step : *way) end += step;
    EXPECT_GE(20 * grid.cell_mm + end.x(), 10 * grid.cell_mm + 30);
  }
}

TEST(EscapePath, IsEmptyInTheOpen) {
  const SolidGrid grid = grid_of(Vec3(80, 60, 60), 0.5);
  const SolidPart block = drawn(shapes::box(Vec3(6, 7, 8)), grid);
  const SolidTray rest(grid, {{&block, 0, 0, 0}});
  const auto way = escape_path(rest, {&block, 40, 24, 0});
  ASSERT_TRUE(way);
  EXPECT_TRUE(way->empty());
}

TEST(DisassemblyOrder, NoneWhereAPartIsShutIn) {
  const SolidGrid grid = grid_of(Vec3(80, 60, 60), 0.5);
  const SolidPart block = drawn(shapes::box(Vec3(6, 7, 8)), grid);
  const SolidPart house = drawn(box_with_window(7.5), grid);
  EXPECT_FALSE(disassembly_order(grid, {{&house, 10, 10, 0}, {&block, 20, 24, 200}}));
  const SolidPart open_house = drawn(box_with_window(10), grid);
  const auto plan = disassembly_order(grid, {{&open_house, 10, 10, 0}, {&block, 20, 24, 200}});
  ASSERT_TRUE(plan);
  EXPECT_EQ(plan->order.front(), 1);
  EXPECT_FALSE(plan->paths[1].empty());
}

// As the models stand, at the least box.
PackProblem standing_problem(std::vector<Mesh> meshes, const Vec3& build_mm) {
  PackProblem problem = shapes::problem_of(std::move(meshes), build_mm);
  problem.rotation_step = 0;
  problem.anywhere = true;
  problem.cost = shapes::paper_cost(1);
  return problem;
}

TEST(Pack, APartGoesUnderACupThatStandsUpsideDown) {
  const Packing packing =
      pack(standing_problem({upside_down(shapes::cup(15, 24, 2)), shapes::box(Vec3(9, 9, 9))},
                            Vec3(60, 60, 60)),
           {});
  EXPECT_NEAR(packing.trays.at(0).size_mm.prod(), 30 * 30 * 24, 50);
}

TEST(Pack, APartGoesIntoABoxOnlyWhereItComesOutAgain) {
  for (const double window : {12.0, 6.0}) {
    const PackProblem problem =
        standing_problem({box_with_window(window), shapes::box(Vec3(8, 8, 8))}, Vec3(60, 60, 60));
    const Packing packing = pack(problem, {});
    check::expect_valid(problem, packing, 0.25);
    ASSERT_EQ(packing.removal_paths.size(), 2U);
    const bool by_a_path = !packing.removal_paths[0].empty() || !packing.removal_paths[1].empty();
    EXPECT_EQ(by_a_path, window > 8) << window;
    const double house_mm3 = 30 * 20 * 24;
    if (window > 8)
      EXPECT_NEAR(packing.cost, house_mm3, 1e-6 * house_mm3);
    else
      EXPECT_GT(packing.cost, 1.2 * house_mm3);
  }
}

TEST(Pack, WaysOutAreTheSameOnOneThreadAndOnTwo) {
  std::vector<Mesh> meshes{box_with_window(12), shapes::box(Vec3(8, 8, 8))};
  Random random(3);
  for (int i = 0; i < 4; ++i) meshes.push_back(shapes::random_solid(random));
  PackProblem problem = standing_problem(std::move(meshes), Vec3(50, 50, 60));
  problem.rotation_step = radians(90);
  const Packing two = pack(problem, {});
  check::expect_valid(problem, two, 0.5);
  const ThreadLimit limit(1);
  const Packing one = pack(problem, {});
  EXPECT_EQ(one.cost, two.cost);
  EXPECT_EQ(one.removal_order, two.removal_order);
  EXPECT_EQ(one.removal_paths, two.removal_paths);
  for (std::size_t i = 0; i < one.parts.size(); ++i)
    EXPECT_EQ(one.parts[i].pose.matrix(), two.parts[i].pose.matrix());
}

}  // namespace
}  // namespace packmerger
