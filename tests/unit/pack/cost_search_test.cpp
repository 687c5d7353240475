// Trays made cheaper while parts stand anywhere: what support they need, where they are cheapest,
// and how they sink.

#include <gtest/gtest.h>

#include <rapidcheck/gtest.h>

#include "base/parallel.h"
#include "pack/lattice/cheapest_place.h"
#include "pack/maps/columns.h"
#include "pack/maps/rotations.h"
#include "pack/pack.h"
#include "pack/separate/separation.h"
#include "pack/separate/sinking.h"
#include "pack/separate/support_pull.h"
#include "unit/pack/check.h"
#include "unit/pack/problems.h"

namespace packmerger {
namespace {

constexpr double kReach_mm = 3;

Mat3 some_rotation(Random& random) {
  const RotationSet set = rotation_set(radians(90));
  const Mat3& way = set.ways_up[random.below(set.ways_up.size())];
  return turn_about_z(random.unit() * 6) * way;
}

double some_angle(Random& random) { return random.below(2) == 0 ? 0 : radians(45); }

// Parts above one another on a lattice, so that none cuts into another.
struct Pile {
  explicit Pile(Random& random)
      : apart_mm(static_cast<double>(random.below(2)) * 0.8), support_angle(some_angle(random)) {
    for (int i = 0; i < 3; ++i) shapes.emplace_back(shapes::random_solid(random), kReach_mm);
    double z_mm = 0;
    for (const Shape& shape : shapes) {
      parts.push_back(supported_part(shape, some_rotation(random), grid, apart_mm, support_angle));
      const BitPart& bits = parts.back().bits;
      places.push_back(
          {static_cast<int>(random.below(static_cast<std::size_t>(grid.columns - bits.width))),
           static_cast<int>(random.below(static_cast<std::size_t>(grid.rows - bits.depth))),
           static_cast<int>(std::ceil(z_mm / grid.unit_mm))});
      z_mm = places.back().z * grid.unit_mm + parts.back().box.max().z();
    }
  }

  // On the lattice's lines, which begin half of the room aside.
  Mesh standing(std::size_t i) const {
    Pose pose = Pose::Identity();
    pose.linear() = parts[i].bits.rotation;
    pose.translation() =
        parts[i].bits.origin - Vec3(0, 0, apart_mm / 2) +
        Vec3(places[i].x * grid.cell_mm, places[i].y * grid.cell_mm, places[i].z * grid.unit_mm);
    return transformed(shapes[i].mesh, pose);
  }

  double support_mm3(const std::vector<std::size_t>& of) const {
    std::vector<Mesh> meshes;
    for (const std::size_t i : of) meshes.push_back(standing(i));
    const ColumnSupport support = column_support(meshes, grid.cell_mm, support_angle, 0);
    return support.below + support.inside;
  }

  double apart_mm;
  double support_angle;
  std::vector<Shape> shapes;
  BitGrid grid{1.2, 150.0 / 62, 50, 42};
  std::vector<SupportedPart> parts;
  std::vector<BitPlace> places;
};

RC_GTEST_PROP(SupportColumns, CountWhatTheMeshesNeed, (std::uint64_t seed)) {
  Random random(seed);
  const Pile pile(random);
  SupportColumns columns(pile.grid);
  const auto put = [&](std::size_t i) {
    const BitPlace& place = pile.places[i];
    const double z_mm = place.z * pile.grid.unit_mm;
    const double before = columns.support_mm3();
    const double added = columns.added_mm3(pile.parts[i], place.x, place.y, z_mm);
    columns.put(pile.parts[i], static_cast<int>(i), place.x, place.y, z_mm);
    RC_ASSERT(std::abs(columns.support_mm3() - before - added) < 0.1);
  };
  const auto expect = [&](const std::vector<std::size_t>& of) {
    const double exact = pile.support_mm3(of);
    RC_ASSERT(std::abs(columns.support_mm3() - exact) < 1e-4 * exact + 0.1);
  };
  // The lowest last: it takes support away.
  for (const std::size_t i : {2, 1, 0}) put(i);
  expect({0, 1, 2});
  columns.take(pile.parts[1], 1, pile.places[1].x, pile.places[1].y);
  expect({0, 2});
}

RC_GTEST_PROP(CheaperPlace, IsTheCheapestByTheEstimate, (std::uint64_t seed)) {
  Random random(seed);
  const Pile pile(random);
  HeightBits tray(pile.grid);
  SupportColumns columns(pile.grid);
  for (std::size_t i = 0; i < 2; ++i) {
    const BitPlace& place = pile.places[i];
    tray.fill(pile.parts[i].bits, place.x, place.y, place.z);
    columns.put(pile.parts[i], static_cast<int>(i), place.x, place.y, place.z * pile.grid.unit_mm);
  }
  columns.pool();
  const SupportedPart& part = pile.parts[2];
  PlaceCosts costs;
  costs.per_mm3 = 0.01;
  const auto some = [&](std::vector<double>& list, int count) {
    for (int i = 0; i < count; ++i) list.push_back(random.unit());
  };
  some(costs.by_column, pile.grid.columns - part.bits.width + 1);
  some(costs.by_row, pile.grid.rows - part.bits.depth + 1);
  some(costs.by_height, 40);
  double least = std::numeric_limits<double>::infinity();
  constexpr int kBlock = SupportedPart::kBlock;
  for (int y = 0; y < static_cast<int>(costs.by_row.size()); ++y)
    for (int x = 0; x < static_cast<int>(costs.by_column.size()); ++x) {
      const std::uint64_t taken = tray.taken(part.bits, x, y);
      const int z = std::countr_one(taken);
      if (z >= static_cast<int>(costs.by_height.size())) continue;
      double above = 0;
      for (int j = 0; j < part.block_rows; ++j)
        for (int i = 0; i < part.block_stride; ++i) {
          const auto block = static_cast<std::size_t>(j * part.block_stride + i);
          if (part.block_cells[block] == 0) continue;
          const double there = *(columns.pooled(x, y + kBlock * j) + i);
          above += static_cast<double>(part.block_cells[block]) *
                   std::max(0.0, z * pile.grid.unit_mm +
                                     static_cast<double>(part.block_height[block]) - there);
        }
      least = std::min(least, costs.per_mm3 * (part.own_mm3 + above * columns.cell_mm2()) +
                                  costs.by_column[static_cast<std::size_t>(x)] +
                                  costs.by_row[static_cast<std::size_t>(y)] +
                                  costs.by_height[static_cast<std::size_t>(z)]);
    }
  CostedPlace found;
  RC_ASSERT(cheaper_place(tray, columns, part, costs, pile.grid.unit_mm, found) ==
            std::isfinite(least));
  if (std::isfinite(least)) RC_ASSERT(std::abs(found.cost - least) < 1e-3 * std::abs(least) + 0.01);
}

RC_GTEST_PROP(SupportPull, IsHowTheSupportChanges, (std::uint64_t seed)) {
  Random random(seed);
  const double angle = some_angle(random);
  const Shape low(shapes::random_solid(random), kReach_mm);
  const Shape high(shapes::random_solid(random), kReach_mm);
  const std::vector<const Shape*> shapes{&low, &high};
  std::vector<Pose> poses(2, Pose::Identity());
  for (Pose& pose : poses) pose.linear() = some_rotation(random);
  poses[0].translation() = Vec3(30, 30, low.radius_mm + 1);
  poses[1].translation() =
      Vec3(30 + 10 * random.unit(), 30, 2 * low.radius_mm + high.radius_mm + 2);
  constexpr double kStep_mm = 0.7;
  const SupportPull pull = support_pull(shapes, poses, kStep_mm, angle);
  Eigen::VectorXd direction(12);
  for (Eigen::Index k = 0; k < 12; ++k) direction[k] = random.unit() - 0.5;
  constexpr double kBy = 1e-6;
  const auto support = [&](double by) {
    return support_pull(shapes, moved(shapes, poses, by * direction), kStep_mm, angle).support_mm3;
  };
  // A line now and then passes from one facet to another on the way.
  const double slope = (support(kBy) - support(-kBy)) / (2 * kBy);
  RC_ASSERT(std::abs(slope - pull.gradient.dot(direction)) <
            0.02 * pull.gradient.cwiseAbs().sum() + 1);
}

TEST(Sinking, PartsSlideDownUntilTheyRest) {
  const Shape slab(shapes::box(Vec3(30, 20, 4)), kReach_mm);
  const Shape ball(shapes::sphere(6, 20), kReach_mm);
  std::vector<Pose> poses(2, Pose::Identity());
  poses[0].linear() = Eigen::AngleAxisd(0.5, Vec3::UnitX()).toRotationMatrix();
  poses[0].translation() = Vec3(20, 20, 14);
  poses[1].translation() = Vec3(20, 42, 20);
  const std::vector<const Shape*> shapes{&slab, &ball};
  const Vec3 box_mm(50, 60, 40);
  const double before = support_pull(shapes, poses, 0.5, 0).support_mm3;
  const auto never = [] { return false; };
  for (int round = 0; round < 8; ++round) {
    sink(shapes, poses, {box_mm, 0.5, 0.5, 0}, Plate(), never);
    ASSERT_TRUE(Separation(shapes, box_mm.head<2>(), 0.5, never).separate(poses, 40, 200));
  }
  EXPECT_LT(support_pull(shapes, poses, 0.5, 0).support_mm3, 0.1 * before);
  EXPECT_GE(least_gap_mm({transformed(slab.mesh, poses[0]), transformed(ball.mesh, poses[1])}),
            0.5);
}

// Cups that may stand over smaller parts, as money counts them on a machine of swaths.
PackProblem costed_problem(double support_angle, double gap_mm) {
  std::vector<Mesh> meshes;
  meshes.push_back(
      shapes::turned(shapes::cup(15, 22, 2, 14),
                     Eigen::AngleAxisd(std::numbers::pi, Vec3::UnitX()).toRotationMatrix()));
  meshes.push_back(shapes::box(Vec3(9, 9, 9)));
  meshes.push_back(shapes::l_shape(18, 4, 9));
  meshes.push_back(shapes::sphere(6, 12));
  PackProblem problem = shapes::problem_of(std::move(meshes), Vec3(80, 60, 60));
  problem.rotation_step = 0;
  problem.gap_mm = gap_mm;
  problem.support_angle = support_angle;
  problem.anywhere = true;
  problem.cost.evaluate = [](const TrayMeasure& tray) {
    return std::ceil(tray.size_mm.y() / 10) * tray.size_mm.z() + 2e-2 * tray.support_mm3;
  };
  problem.cost.lower_bound = problem.cost.evaluate;
  return problem;
}

TEST(SearchByCost, TraysAreCheaperAndHold) {
  for (const double angle : {0.0, radians(45)}) {
    PackProblem problem = costed_problem(angle, angle > 0 ? 0 : 0.6);
    const Packing anywhere = pack(problem, {});
    check::expect_valid(problem, anywhere, 0.25);
    problem.anywhere = false;
    EXPECT_LT(anywhere.cost, 0.97 * pack(problem, {}).cost) << angle;
  }
}

TEST(SearchByCost, IsTheSameOnOneThreadAndOnTwo) {
  PackProblem problem = costed_problem(0, 0.6);
  problem.build_mm = Vec3(34, 32, 23);
  const Packing two = pack(problem, {});
  EXPECT_GT(two.trays.size(), 1U);
  check::expect_valid(problem, two, 0.25);
  const ThreadLimit limit(1);
  const Packing one = pack(problem, {});
  check::expect_same(one, two);
}

}  // namespace
}  // namespace packmerger
