// Plates that are no rectangle, and areas that are kept out: nothing that is packed stands over a
// wall.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "base/random.h"
#include "pack/exact/exact_disassembly.h"
#include "pack/maps/plate_mask.h"
#include "pack/pack.h"
#include "pack/separate/separation.h"
#include "unit/pack/check.h"
#include "unit/pack/problems.h"

namespace packmerger {
namespace {

Polygon regular(const Vec2& middle, double radius, int corners, double turn = 0) {
  Polygon polygon;
  for (int i = 0; i < corners; ++i) {
    const double angle = turn + 2 * std::numbers::pi * i / corners;
    polygon.emplace_back(middle + radius * Vec2(std::cos(angle), std::sin(angle)));
  }
  return polygon;
}

struct Walls {
  Polygon outline;  // may be empty
  std::vector<Polygon> kept_out;

  bool allow(const Vec2& at) const {
    return (outline.empty() || contains(outline, at)) &&
           std::none_of(kept_out.begin(), kept_out.end(),
                        [&](const Polygon& area) { return contains(area, at); });
  }
};

// Looks at points all over the triangles, drawn in by a hair: what touches a wall is allowed.
void expect_clear(const PackProblem& problem, const Packing& packing, const Walls& walls) {
  constexpr int kSteps = 12;
  for (const PlacedPart& part : packing.parts)
    for (const check::Triangle& triangle : check::placed_triangles(problem, part)) {
      const Vec3 middle = (triangle[0] + triangle[1] + triangle[2]) / 3;
      for (int i = 0; i <= kSteps; ++i)
        for (int k = 0; i + k <= kSteps; ++k) {
          const Vec3 at =
              (i * triangle[0] + k * triangle[1] + (kSteps - i - k) * triangle[2]) / kSteps;
          const Vec3 drawn_in = at + 1e-5 * (middle - at).normalized();
          if (middle == at) continue;
          ASSERT_TRUE(walls.allow(drawn_in.head<2>())) << at.transpose();
        }
    }
}

Mesh some_shape(Random& random) {
  switch (random.below(4)) {
    case 0:
      return shapes::box(
          Vec3(3 + 12 * random.unit(), 3 + 12 * random.unit(), 3 + 12 * random.unit()));
    case 1:
      return shapes::l_shape(14, 3, 6);
    case 2:
      return shapes::cup(7, 9, 2, 12);
    default:
      return shapes::bowl(9, 2, 12);
  }
}

Walls some_walls(Random& random) {
  Walls walls;
  const Vec2 middle(30, 28);
  if (random.below(3) > 0)
    walls.outline = regular(middle, 20 + 8 * random.unit(), 3 + static_cast<int>(random.below(60)),
                            random.unit());
  if (random.below(3) == 0)  // an L
    walls.outline = {{0, 0}, {60, 0}, {60, 25}, {24.3, 25}, {24.3, 55}, {0, 55}};
  for (std::size_t i = random.below(3); i > 0; --i)
    walls.kept_out.push_back(regular(Vec2(60 * random.unit(), 55 * random.unit()),
                                     1 + 6 * random.unit(), 3 + static_cast<int>(random.below(5)),
                                     random.unit()));
  return walls;
}

TEST(PackOnPlates, NothingStandsOverAWall) {
  int packed = 0;
  for (int round = 0; round < 10; ++round) {
    Random random(static_cast<std::uint64_t>(round));
    std::vector<Mesh> meshes;
    for (std::size_t i = 2 + random.below(4); i > 0; --i) meshes.push_back(some_shape(random));
    PackProblem problem = shapes::problem_of(std::move(meshes), Vec3(60, 55.3, 50));
    const Walls walls = some_walls(random);
    problem.plate = Plate(walls.outline, walls.kept_out);
    problem.gap_mm = static_cast<double>(random.below(2));
    problem.anywhere = round % 5 == 4;
    std::optional<Packing> packing;
    try {
      packing = pack(problem, Progress());
    } catch (const Error& error) {
      EXPECT_EQ(error.fault(), Fault::kBadInput);  // a part fits this plate nowhere
      continue;
    }
    ++packed;
    check::expect_valid(problem, *packing, 0.3);
    expect_clear(problem, *packing, walls);
    for (const PlacedPart& part : packing->parts) {
      const Mesh& surface = problem.items[static_cast<std::size_t>(part.items.front())].surface;
      EXPECT_LE(problem.plate.breach_mm(surface, part.pose), kWallTolerance_mm);
    }
  }
  EXPECT_GE(packed, 7);
}

TEST(PackOnPlates, WhatStandsAnywhereStandsOverNoWallEither) {
  std::vector<Mesh> meshes;
  for (int i = 0; i < 2; ++i) meshes.push_back(shapes::cup(8, 14, 2, 12));
  for (int i = 0; i < 2; ++i) meshes.push_back(shapes::sphere(5, 10));
  for (int i = 0; i < 4; ++i) meshes.push_back(shapes::l_shape(16, 4, 8));
  PackProblem problem = shapes::low_problem(std::move(meshes), Vec3(44, 42, 90), 0.5);
  const Walls walls{regular(Vec2(22, 21), 22, 8, 0.3), {regular(Vec2(30, 22), 3, 5)}};
  problem.plate = Plate(walls.outline, walls.kept_out);
  const Packing packing = pack(problem, Progress());
  check::expect_valid(problem, packing, 0.25);
  expect_clear(problem, packing, walls);
  problem.anywhere = false;
  EXPECT_LT(packing.cost, 0.95 * pack(problem, Progress()).cost);
}

TEST(SeparationOnPlates, MovesPartsOffTheWalls) {
  const Shape cube(shapes::box(Vec3(10, 10, 10)), 3);
  // Lies flat, with the kept-out area between its legs.
  const Shape angle(
      shapes::turned(shapes::l_shape(18, 5, 10),
                     Eigen::AngleAxisd(std::numbers::pi / 2, Vec3::UnitX()).toRotationMatrix()),
      3);
  const Walls walls{regular(Vec2(20, 20), 20, 12), {regular(Vec2(24, 20), 3, 6)}};
  const Plate plate(walls.outline, walls.kept_out);
  std::vector<Pose> poses(2, Pose::Identity());
  poses[0].translation() = Vec3(8, 12, 6);
  poses[1].translation() = Vec3(26, 21, 6);
  const std::vector<const Shape*> shapes{&cube, &angle};
  EXPECT_GT(plate.breach_mm(cube.mesh, poses[0]), 0.1);
  EXPECT_GT(plate.breach_mm(angle.mesh, poses[1]), 0.1);
  const Vec3 box_mm(40, 40, 14);
  const Overlap here = overlap(shapes, poses, box_mm, Rooms(2, 0.5), plate);
  for (Eigen::Index k = 0; k < here.gradient.size(); ++k) {
    constexpr double kStep = 1e-5;
    const auto energy = [&](double step) {
      const Eigen::VectorXd by = step * Eigen::VectorXd::Unit(here.gradient.size(), k);
      return overlap(shapes, moved(shapes, poses, by), box_mm, Rooms(2, 0.5), plate).energy;
    };
    EXPECT_NEAR(here.gradient[k], (energy(kStep) - energy(-kStep)) / (2 * kStep),
                1e-3 * here.gradient.norm());
  }
  const Separation separation(
      shapes, Vec2(40, 40), 0.5, [] { return false; }, plate);
  ASSERT_TRUE(separation.separate(poses, 14, 200));
  EXPECT_EQ(plate.breach_mm(cube.mesh, poses[0]), 0);
  EXPECT_EQ(plate.breach_mm(angle.mesh, poses[1]), 0);
}

// A U on its side, open to the right, as deep as the base, and a cube between its legs: it can be
// drawn out to the right alone, unless a wall is in its way.
TEST(DisassemblyOnPlates, LeadsOverNoWall) {
  const auto at = [](const Mesh& mesh, const Vec3& low) {
    return transformed(mesh, Pose(Eigen::Translation3d(Vec3(low - bounding_box(mesh).min()))));
  };
  const Mesh u = shapes::extruded(
      {{0, 0}, {20, 0}, {20, 5}, {5, 5}, {5, 25}, {20, 25}, {20, 30}, {0, 30}, {0, 25}, {0, 5}},
      {{0, 1, 2, 3, 9}, {9, 3, 4, 8}, {4, 5, 6, 7, 8}}, 10);
  const std::vector<Mesh> parts{at(u, Vec3(0, 0, 0)),
                                at(shapes::box(Vec3(8, 9, 8)), Vec3(6, 0.5, 10))};
  const Vec2 base_mm(45, 10);
  EXPECT_TRUE(exact_disassembly(parts, base_mm, {}).stuck.empty());
  const std::vector<int> both{0, 1};
  const Plate narrow({{0, 0}, {24, 0}, {24, 10}, {0, 10}}, {});
  EXPECT_EQ(exact_disassembly(parts, base_mm, {}, narrow).stuck, both);
  const Plate pin({}, {{{22, 4}, {23, 4}, {23, 6}, {22, 6}}});
  EXPECT_EQ(exact_disassembly(parts, base_mm, {}, pin).stuck, both);
  const Plate far({}, {{{40, 4}, {41, 4}, {41, 6}, {40, 6}}});
  EXPECT_TRUE(exact_disassembly(parts, base_mm, {}, far).stuck.empty());
}

TEST(PackOnPlates, ARoundPlateTakesWhatItsSquareTakesLess) {
  // Nine cubes on a disc that has room for seven.
  std::vector<Mesh> cubes(9, shapes::box(Vec3(18, 18, 18)));
  PackProblem problem = shapes::problem_of(cubes, Vec3(60, 60, 18.5));
  problem.rotation_step = radians(360);
  problem.gap_mm = 1;
  EXPECT_EQ(pack(problem, Progress()).trays.size(), 1U);
  const Walls walls{regular(Vec2(30, 30), 30, 72), {}};
  problem.plate = Plate(walls.outline, {});
  const Packing packing = pack(problem, Progress());
  EXPECT_GT(packing.trays.size(), 1U);
  check::expect_valid(problem, packing, 0.3);
  expect_clear(problem, packing, walls);
}

TEST(PackOnPlates, APartThatFillsThePlateStandsBetweenTheCells) {
  // A drum of 59.9 mm on a disc of 60: no multiple of the grid's cell centres it.
  const Mesh drum = shapes::cup(29.95, 10, 4, 72);
  PackProblem problem = shapes::problem_of({drum, drum}, Vec3(60.13, 60.13, 50));
  problem.rotation_step = radians(360);
  const Walls walls{regular(Vec2(30.065, 30.065), 30.05, 180), {}};
  problem.plate = Plate(walls.outline, {});
  const Packing packing = pack(problem, Progress());
  check::expect_valid(problem, packing, 0.5);
  expect_clear(problem, packing, walls);
}

TEST(PackOnPlates, WhatFitsTheBoxButNotThePlateIsRefused) {
  PackProblem problem = shapes::problem_of({shapes::box(Vec3(50, 50, 50))}, Vec3(60, 60, 60));
  pack(problem, Progress());
  problem.plate = Plate(regular(Vec2(30, 30), 30, 72), {});
  try {
    pack(problem, Progress());
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.fault(), Fault::kBadInput);
    EXPECT_NE(std::string(error.what()).find("walls of its plate"), std::string::npos);
  }
}

TEST(PackOnPlates, APartMayStandRoundAKeptOutArea) {
  // An L that lies flat and has its corner in the tray's: the area lies within its box.
  PackProblem problem = shapes::problem_of({shapes::l_shape(40, 8, 5)}, Vec3(41, 41, 6));
  const Walls walls{{}, {regular(Vec2(30, 30), 8, 8)}};
  problem.plate = Plate(walls.outline, walls.kept_out);
  const Packing packing = pack(problem, Progress());
  check::expect_valid(problem, packing, 0.5);
  expect_clear(problem, packing, walls);
}

TEST(PlateMasks, BarExactlyWhatStandsOverAWall) {
  for (int round = 0; round < 30; ++round) {
    Random random(static_cast<std::uint64_t>(round));
    const Walls walls = some_walls(random);
    const Plate plate(walls.outline, walls.kept_out);
    const Vec3 build(60, 55.3, 10);
    const double cell = 0.7 + random.unit();
    const PlateMask mask(plate, build, cell, true);
    if (plate.is_whole()) {
      EXPECT_TRUE(mask.empty());
      continue;
    }
    // A footprint of one cell, and one of two apart: barred where their squares stand over a wall.
    for (const int apart : {0, 4}) {
      const Box3 box(Vec3(0, 0, 0), Vec3((apart + 1) * cell, cell, 1));
      const BarredPositions barred = mask.barred({{apart, 0}, {0, 0}}, box);
      const Range xs = inside_tray(box, build, cell, 0);
      const Range ys = inside_tray(box, build, cell, 1);
      for (int y = ys.first; y <= ys.last; ++y)
        for (int x = xs.first; x <= xs.last; ++x) {
          double breach = 0;
          for (const int cells : {0, apart})
            breach = std::max(
                breach, plate.breach_mm(
                            shapes::box(Vec3(cell, cell, 1), Vec3((x + cells) * cell, y * cell, 0)),
                            Pose::Identity()));
          const bool is_barred = !barred.empty() && barred.at(x, y);
          EXPECT_TRUE(is_barred || breach <= kWallTolerance_mm) << x << " " << y << " " << breach;
          EXPECT_TRUE(!is_barred || breach > kWallTolerance_mm / 10) << x << " " << y;
        }
    }
  }
}

}  // namespace
}  // namespace packmerger
