#include "shape/solid/hollow.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "base/error.h"
#include "base/parallel.h"
#include "fixtures/block_solid.h"
#include "fixtures/models.h"
#include "shape/read/soup.h"
#include "shape/solid/solidify.h"
#include "shape/surface/repair.h"
#include "shape/surface/surface_query.h"

namespace packmerger {
namespace {

bool warned(const Warnings& warnings, const std::string& code) {
  return std::any_of(warnings.begin(), warnings.end(),
                     [&](const Warning& warning) { return warning.code == code; });
}

Shell hollowed(const TriangleSoup& soup, Warnings& warnings, const ShapeSettings& settings = {}) {
  return hollow(closed_mesh(soup), settings, warnings, Progress());
}

void expect_good_cavities(const Shell& shell, double wall_mm) {
  ASSERT_EQ(shell.cavities.size(), shell.cavity_points.size());
  const SurfaceQuery outer(shell.outer);
  double volume = volume_mm3(shell.outer);
  for (std::size_t i = 0; i < shell.cavities.size(); ++i) {
    const Mesh& cavity = shell.cavities[i];
    const TriangleView soup(cavity);
    EXPECT_TRUE(is_closed_manifold(soup));
    EXPECT_EQ(components_of(soup).count, 1);
    EXPECT_FALSE(self_intersects(cavity));
    EXPECT_LT(volume_mm3(cavity), 0) << "normals point into the cavity";
    EXPECT_EQ(SurfaceQuery(soup).winding_number(shell.cavity_points[i]), -1);
    volume += volume_mm3(cavity);
    for (const auto& [a, b, c] : soup.triangles) {
      const Vec3 middle = (soup.points[a] + soup.points[b] + soup.points[c]) / 3;
      EXPECT_GE(outer.distance_mm(middle), 0.9 * wall_mm);
      EXPECT_EQ(outer.winding_number(middle), 1);
    }
    for (const Vec3& point : soup.points) EXPECT_GE(outer.distance_mm(point), 0.9 * wall_mm);
  }
  EXPECT_NEAR(shell.volume_mm3, volume, 1e-6 * std::abs(volume));
}

TEST(Hollow, CubeHasTheWallItIsTold) {
  Warnings warnings;
  const Shell shell = hollowed(fixtures::cube(40), warnings);
  expect_good_cavities(shell, 3);
  ASSERT_EQ(shell.cavities.size(), 1u);
  EXPECT_NEAR(-volume_mm3(shell.cavities[0]), 34 * 34 * 34, 0.01 * 34 * 34 * 34);
  EXPECT_LT(shell.cavities[0].n_triangles(), 2000u) << "flat faces need few triangles";
  EXPECT_TRUE(warned(warnings, "sealed_cavity"));
  EXPECT_FALSE(warned(warnings, "thin_features"));
}

// A box of 40 mm with a slit from above, too narrow for any voxel.
TriangleSoup slit_box() {
  const std::array<std::array<double, 2>, 8> outline = {
      {{0, 0}, {40, 0}, {40, 40}, {20.02, 40}, {20.02, 20}, {19.98, 20}, {19.98, 40}, {0, 40}}};
  const std::array<std::array<int, 3>, 6> cap = {
      {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {0, 4, 5}, {0, 5, 7}, {5, 6, 7}}};
  TriangleSoup soup;
  for (const double z : {0.0, 40.0})
    for (const auto& [x, y] : outline) soup.points.emplace_back(x, y, z);
  for (const auto& [a, b, c] : cap) {
    soup.triangles.push_back({c, b, a});
    soup.triangles.push_back({a + 8, b + 8, c + 8});
  }
  for (int i = 0; i < 8; ++i) {
    const int next = (i + 1) % 8;
    soup.triangles.push_back({i, next, next + 8});
    soup.triangles.push_back({i, next + 8, i + 8});
  }
  return soup;
}

TEST(Hollow, CrevicesNarrowerThanAVoxelHaveTheirWall) {
  Warnings warnings;
  const Shell shell = hollowed(slit_box(), warnings);
  expect_good_cavities(shell, 3);
  double space = 0;
  for (const Mesh& cavity : shell.cavities) space -= volume_mm3(cavity);
  const double expected = 34 * 34 * 34 - 6.04 * 20 * 34;
  EXPECT_NEAR(space, expected, 0.03 * expected);
}

// A box with a chamber in it and a square hole through the middle of its lowest wall.
TriangleSoup drained_box(double side, double wall, double hole) {
  const std::vector<double> across = {0,           wall, (side - hole) / 2, (side + hole) / 2,
                                      side - wall, side};
  const auto filled = [](int x, int y, int z) {
    const bool in_chamber = z == 1 && x > 0 && x < 4 && y > 0 && y < 4;
    return !in_chamber && !(z == 0 && x == 2 && y == 2);
  };
  return fixtures::block_solid(across, across, {0, wall, side - wall, side}, filled);
}

TEST(Hollow, ChambersWithANarrowWayOutAreNoMatter) {
  for (const auto& [wall, hole] : {std::array{4.0, 1.0}, std::array{2.0, 1.4}}) {
    Warnings warnings;
    const Shell shell = hollowed(drained_box(40, wall, hole), warnings);
    EXPECT_TRUE(shell.cavities.empty()) << wall;
    EXPECT_DOUBLE_EQ(shell.volume_mm3, volume_mm3(shell.outer));
    EXPECT_FALSE(warned(warnings, "sealed_cavity"));
    const Solidified solid = solidify(shell.outer, {}, true, warnings, Progress());
    EXPECT_NEAR(total_volume_mm3(solid.tets), shell.volume_mm3, 1e-6 * shell.volume_mm3);
    EXPECT_FALSE(solid.resample_tolerance_mm);
  }
}

TEST(Hollow, TheWallAroundAChamberWithANarrowWayOutIsHollowed) {
  Warnings warnings;
  const Shell shell = hollowed(drained_box(34, 10, 1), warnings);
  expect_good_cavities(shell, 3);
  ASSERT_EQ(shell.cavities.size(), 1u);
  const double expected = 28 * 28 * 28 - 20 * 20 * 20;
  EXPECT_NEAR(-volume_mm3(shell.cavities[0]), expected, 0.03 * expected);
}

TEST(Hollow, SphereAndTorus) {
  Warnings warnings;
  const Shell ball = hollowed(fixtures::sphere(20, 4), warnings);
  expect_good_cavities(ball, 3);
  EXPECT_NEAR(-volume_mm3(ball.cavities.at(0)), 4.0 / 3 * 3.14159 * 17 * 17 * 17, 800);
  const Shell ring = hollowed(fixtures::torus(30, 10, 60, 30), warnings);
  expect_good_cavities(ring, 3);
  EXPECT_EQ(ring.cavities.size(), 1u);
}

TEST(Hollow, TooThinIsNotAnError) {
  Warnings warnings;
  const Shell shell = hollowed(fixtures::thin_plate(50, 4), warnings);
  EXPECT_TRUE(shell.cavities.empty());
  EXPECT_NEAR(shell.volume_mm3, 50 * 50 * 4, 1e-6);
  EXPECT_FALSE(warned(warnings, "sealed_cavity"));
  EXPECT_TRUE(warned(warnings, "thin_features"));
}

TEST(Hollow, SmallCavitiesStaySolid) {
  Warnings warnings;
  ShapeSettings settings;
  settings.min_cavity_mm3 = 1e5;
  EXPECT_TRUE(hollowed(fixtures::cube(40), warnings, settings).cavities.empty());
}

TEST(Hollow, OwnCavityWhoseWallWouldFloatJoinsTheNewOne) {
  Warnings warnings;
  const Shell shell = hollowed(fixtures::nested_cubes(60, 20), warnings);
  expect_good_cavities(shell, 3);
  EXPECT_EQ(shell.cavities.size(), 1u);
  EXPECT_EQ(components_of(shell.outer).count, 1);
  EXPECT_NEAR(shell.volume_mm3, 60 * 60 * 60 - 54 * 54 * 54, 2000);
}

TEST(Hollow, OwnCavityStaysWhereThereIsNoRoom) {
  Warnings warnings;
  const Shell shell = hollowed(fixtures::nested_cubes(40, 30), warnings);
  EXPECT_TRUE(shell.cavities.empty());
  EXPECT_EQ(components_of(shell.outer).count, 2);
  EXPECT_NEAR(shell.volume_mm3, 40 * 40 * 40 - 30 * 30 * 30, 1e-6);
}

TEST(Hollow, MatterInAnOwnCavityIsHollowedToo) {
  Warnings warnings;
  const Shell shell =
      hollowed(fixtures::together(fixtures::nested_cubes(60, 52),
                                  fixtures::box(Vec3::Constant(10), Vec3::Constant(50))),
               warnings);
  expect_good_cavities(shell, 3);
  EXPECT_EQ(components_of(shell.outer).count, 3);
  ASSERT_EQ(shell.cavities.size(), 1u);
  EXPECT_NEAR(-volume_mm3(shell.cavities[0]), 34 * 34 * 34, 1000);
}

// Such surfaces come where bodies that overlap could not be united.
TEST(Hollow, WhatIsEnclosedTwiceStaysSolid) {
  const TriangleSoup crossing = fixtures::together(
      fixtures::cube(40), fixtures::box(Vec3::Constant(13.1), Vec3::Constant(53.1)));
  ASSERT_TRUE(self_intersects(closed_mesh(crossing)));
  Warnings warnings;
  const Shell shell = hollowed(crossing, warnings);
  expect_good_cavities(shell, 3);
  ASSERT_EQ(shell.cavities.size(), 2u) << "one in each body, beside the other";
  for (const Mesh& cavity : shell.cavities)
    EXPECT_NEAR(-volume_mm3(cavity), 34 * 34 * 34 - 26.9 * 26.9 * 26.9, 1500);
}

TEST(Hollow, SameBytesOnOneAndTwoThreads) {
  const TriangleSoup model = fixtures::blob(36, 3);
  const auto with_threads = [&](std::size_t threads) {
    const ThreadLimit limit(threads);
    Warnings warnings;
    return hollowed(model, warnings);
  };
  const Shell one = with_threads(1);
  const Shell two = with_threads(2);
  expect_good_cavities(one, 3);
  ASSERT_EQ(one.cavities.size(), two.cavities.size());
  for (std::size_t i = 0; i < one.cavities.size(); ++i) {
    EXPECT_EQ(one.cavities[i].points(), two.cavities[i].points());
    EXPECT_EQ(one.cavities[i].triangles(), two.cavities[i].triangles());
  }
}

TEST(Hollow, RefusesAGridWithoutBounds) {
  Warnings warnings;
  ShapeSettings settings;
  settings.voxel_mm = 0.001;
  EXPECT_THROW(hollowed(fixtures::cube(100), warnings, settings), Error);
}

TEST(Hollow, RealModelsKeepTheWall) {
  for (const char* file : {"spot.obj", "rocker-arm.obj"}) {
    PACKMERGER_TEST_MODEL(soup, file);
    Warnings warnings;
    const Shell shell = hollowed(fixtures::scaled_to(soup, 100), warnings);
    expect_good_cavities(shell, 3);
    EXPECT_FALSE(shell.cavities.empty());
  }
}

}  // namespace
}  // namespace packmerger
