// The packer's pieces: rotations, columns, tabu search, exact gaps.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include <rapidcheck/gtest.h>

#include "base/random.h"
#include "bench/order.h"
#include "pack/exact/exact_gap.h"
#include "pack/maps/columns.h"
#include "pack/maps/merge.h"
#include "pack/maps/rotations.h"
#include "pack/search/moves.h"
#include "pack/search/search.h"
#include "unit/pack/check.h"
#include "unit/pack/problems.h"

namespace packmerger {
namespace {

TEST(Rotations, AreTheDifferentProductsOfSteps) {
  EXPECT_EQ(rotation_set(0).ways_up.size(), 1U);
  EXPECT_EQ(rotation_set(radians(90)).ways_up.size(), 6U);
  EXPECT_EQ(rotation_set(radians(90)).turns.size(), 4U);
  const RotationSet set = rotation_set(radians(30));
  EXPECT_EQ(set.ways_up.size(), 62U);
  EXPECT_EQ(set.turns.size(), 12U);
  // Any product of steps about three axes is among them.
  Random random(1);
  for (int i = 0; i < 50; ++i) {
    const auto turn = [&random](const Vec3& axis) {
      return Eigen::AngleAxisd(radians(30.0 * static_cast<double>(random.below(12))), axis);
    };
    const Mat3 wanted =
        (turn(Vec3::UnitZ()) * turn(Vec3::UnitY()) * turn(Vec3::UnitX())).toRotationMatrix();
    double nearest = 10;
    for (const Mat3& way : set.ways_up)
      for (const double angle : set.turns)
        nearest = std::min(nearest, (turn_about_z(angle) * way - wanted).norm());
    EXPECT_LT(nearest, 1e-9);
  }
}

// A maker of the only part of a problem, and the part.
struct OnePart {
  OnePart(Mesh mesh, bool bounds)
      : problem(shapes::problem_of({std::move(mesh)}, Vec3(120, 120, 120))),
        maker(problem, {1, height_unit_mm(120), problem.gap_mm, bounds}, [] {}),
        part(*maker.make({0})) {}

  std::vector<const RotatedPart*> turned_by_steps(int steps) {
    std::vector<const RotatedPart*> rotations;
    for (int i = 0; i < steps; ++i)
      rotations.push_back(maker.rotated(part, turn_about_z(radians(360.0 * i / steps)), 0));
    return rotations;
  }

  PackProblem problem;
  PartMaker maker;
  const Part& part;
};

TEST(Rotations, BetweenDirectionsAreRigidNearOppositeOnesToo) {
  for (double sine = 1; sine > 1e-9; sine /= 3)
    for (const double cosine : {-std::sqrt(1 - sine * sine), std::sqrt(1 - sine * sine)}) {
      const Vec3 from = 7 * Vec3(0.6 * sine, -0.8 * sine, cosine);
      const Mat3 turn = turn_between(from, Vec3::UnitZ());
      EXPECT_LT((turn * turn.transpose() - Mat3::Identity()).norm(), 1e-14) << sine;
      EXPECT_NEAR(turn.determinant(), 1, 1e-14) << sine;
      EXPECT_LT((turn * from - 7 * Vec3::UnitZ()).norm(), 1e-5) << sine;
    }
}

TEST(Different, ABrickLiesInSixWaysAndACubeInOne) {
  for (const bool bounds : {true, false}) {
    OnePart brick(shapes::box(Vec3(20, 10, 6)), bounds);
    Moves moves(brick.problem, brick.maker);
    EXPECT_EQ(moves.good_rotations(brick.part, 6).size(), 6U);
    OnePart cube(shapes::box(Vec3(10, 10, 10)), bounds);
    EXPECT_EQ(Moves(cube.problem, cube.maker).good_rotations(cube.part, 6).size(), 1U);
  }
}

TEST(Different, APatchOfASphereLooksTheSameAfterHalfATurnAndNoOther) {
  for (const bool bounds : {true, false}) {
    OnePart patch(shapes::sphere_patch(30, 3, 4, 6), bounds);
    const auto rotations = patch.turned_by_steps(12);
    EXPECT_EQ(different({rotations[0], rotations[1], rotations[2]}).size(), 3U);
    const auto kept = different(rotations);
    EXPECT_EQ(kept, std::vector(rotations.begin(), rotations.begin() + 6));
  }
}

TEST(Different, AnAngleHasNoSymmetry) {
  OnePart angle(shapes::l_shape(20, 4, 10), true);
  EXPECT_EQ(different(angle.turned_by_steps(12)).size(), 12U);
}

TEST(Different, SomeRotationsHaveNoTwins) {
  OnePart brick(shapes::box(Vec3(20, 10, 6)), true);
  Moves moves(brick.problem, brick.maker);
  Random random(1);
  for (int i = 0; i < 20; ++i) {
    const auto some = moves.some_rotations(brick.part, random);
    EXPECT_EQ(different(some).size(), some.size());
    EXPECT_GT(some.size(), 1U);
  }
}

TEST(PartMaker, CopiesShareWhatIsDrawn) {
  // The third looks the same but stands elsewhere in its model's frame.
  const PackProblem problem = shapes::problem_of(
      {shapes::l_shape(20, 4, 10), shapes::l_shape(20, 4, 10),
       transformed(shapes::l_shape(20, 4, 10), Pose(Eigen::Translation3d(5, 0, 0)))},
      Vec3(60, 60, 60));
  PartMaker maker(problem, {1, 1.0 / 64, 1, true}, [] {});
  const auto first_rotation = [&maker](int item) {
    return maker.rotated(*maker.make({item}), 0, 0);
  };
  EXPECT_EQ(first_rotation(0), first_rotation(1));
  EXPECT_NE(first_rotation(0), first_rotation(2));
}

TEST(PartMaker, AMergedPartStandsAsItsMembersTogether) {
  // Two halves of a block, and beside them the block as one item; at 0 degrees and at 45.
  const Mesh half = shapes::box(Vec3(12, 8, 6));
  const Mesh other = transformed(half, Pose(Eigen::Translation3d(0, 8, 0)));
  for (const double angle : {0.0, 0.8}) {
    PackProblem halves = shapes::problem_of({half, other}, Vec3(60, 60, 60));
    for (PackItem& item : halves.items) item.model = 0;
    halves.edges = {{0, 1, 72}};
    halves.support_angle = angle;
    PackProblem whole = halves;
    whole.items = {PackItem{shapes::box(Vec3(12, 16, 6)), 12 * 16 * 6, 0}};
    whole.edges.clear();
    PartMaker of_halves(halves, {0.4, 1.0 / 64, 1, false}, [] {});
    PartMaker of_whole(whole, {0.4, 1.0 / 64, 1, false}, [] {});
    const WayUp merged = of_halves.make({0, 1})->ways.front();
    const WayUp single = of_whole.make({0})->ways.front();
    EXPECT_LT((merged.size_mm - single.size_mm).norm(), 1e-6);
    EXPECT_NEAR(merged.support_mm3, single.support_mm3, 0.02 * 12 * 16 * 6);
    EXPECT_NEAR(merged.cost, single.cost, 1e-2 * single.cost);
  }
}

TEST(Search, TellsTheCostOfEachBetterLayout) {
  PackProblem problem = shapes::problem_of(
      {shapes::cup(9, 12, 2), shapes::l_shape(18, 4, 10), shapes::bowl(10, 2),
       shapes::tetrahedron(16), shapes::l_shape(14, 3, 12), shapes::cup(7, 10, 1)},
      Vec3(60, 60, 60));
  problem.tabu_patience = 10;
  Pace pace({}, 0);
  const TraySpec spec{problem.build_mm, {3, height_unit_mm(60), 1, false}, &problem.cost};
  PartMaker maker(problem, spec.grid, [] {});
  std::vector<double> told;
  const std::vector<Layout> found =
      search(problem, Layouter(spec), maker, pace, [&](double cost) { told.push_back(cost); });
  ASSERT_GT(told.size(), 1U);
  EXPECT_TRUE(std::is_sorted(told.rbegin(), told.rend()));
  EXPECT_EQ(std::adjacent_find(told.begin(), told.end()), told.end());
  EXPECT_EQ(told.back(), found.front().cost);
}

TEST(Columns, CountWhatTheFormulaSays) {
  // A ball on the plate: between it and the plate lie π r³ / 3.
  const Mesh ball = shapes::sphere(10, 96);
  const ColumnSupport support = column_support({ball}, 0.1, 0, -10);
  EXPECT_NEAR(support.below, std::numbers::pi * 1000 / 3, 15);
  EXPECT_EQ(support.inside, 0);
  // Below 45° only the part of the surface within 45° of the pole needs support.
  const double s = std::sqrt(0.5);
  const double cap = std::numbers::pi * 1000 * (s * s - 2.0 / 3 * (1 - s * s * s));
  EXPECT_NEAR(column_support({ball}, 0.1, radians(45), -10).below, cap, 15);
  EXPECT_EQ(column_support({ball}, 0.1, radians(90), -10).below, 0);
}

TEST(Columns, CupUpsideDownIsFullOfSupportAndUprightIsNot) {
  const Mesh cup = shapes::cup(10, 20, 2, 48);
  EXPECT_NEAR(column_support({cup}, 0.2, 0, 0).below, 0, 1e-9);
  Mat3 over = Mat3::Identity();
  over(1, 1) = over(2, 2) = -1;
  const ColumnSupport support = column_support({shapes::turned(cup, over)}, 0.2, 0, -20);
  EXPECT_NEAR(support.below, std::numbers::pi * 64 * 18, 60);
  // On its side, the lower wall carries what supports the upper one.
  Mat3 aside;
  aside << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  EXPECT_GT(column_support({shapes::turned(cup, aside)}, 0.2, 0, -10).inside, 1000);
}

RC_GTEST_PROP(Columns, AgreeWithTheEnvelopeAtZeroDegrees, (std::uint64_t seed)) {
  // At 0° the support is the volume under the upper envelope less the matter.
  Random random(seed);
  const Mesh bowl = shapes::turned(shapes::bowl(15, 2, 24), shapes::any_rotation(random));
  const double plate = bounding_box(bowl).min().z();
  const ColumnSupport support = column_support({bowl}, 0.25, 0, plate);
  PackProblem problem = shapes::problem_of({bowl}, Vec3(80, 80, 80));
  PlacedPart part{{0}, Pose::Identity(), 0};
  part.pose.translation() = Vec3(40, 40, -plate);
  const check::Columns columns(check::placed_triangles(problem, part), problem.build_mm, 0.25);
  double envelope = 0;
  for (const double top : columns.high)
    if (std::isfinite(top)) envelope += top * 0.25 * 0.25;
  const double expected = envelope - volume_mm3(bowl);
  RC_ASSERT(std::abs(support.below + support.inside - expected) < 0.02 * expected + 40);
}

TEST(ExactGap, KnownDistances) {
  const Mesh a = shapes::box(Vec3(10, 10, 10));
  EXPECT_EQ(least_gap_mm({a}), std::numeric_limits<double>::infinity());
  EXPECT_NEAR(least_gap_mm({a, shapes::box(Vec3(5, 5, 5), Vec3(11.5, 2, 2))}), 1.5, 1e-9);
  EXPECT_NEAR(least_gap_mm({a, shapes::box(Vec3(5, 5, 5), Vec3(13, 14, 10))}), 5, 1e-9);
  EXPECT_EQ(least_gap_mm({a, shapes::box(Vec3(5, 5, 5), Vec3(8, 8, 8))}), 0);
  EXPECT_EQ(least_gap_mm({a, shapes::box(Vec3(2, 2, 2), Vec3(4, 4, 4))}), 0);  // swallowed
  EXPECT_EQ(least_gap_mm({shapes::box(Vec3(2, 2, 2), Vec3(4, 4, 4)), a}), 0);
  EXPECT_GE(least_gap_mm({a, shapes::box(Vec3(5, 5, 5), Vec3(40, 0, 0))}, 2), 2);
  // In a cup, but not in its matter.
  EXPECT_NEAR(
      least_gap_mm({shapes::cup(10, 20, 2, 48), shapes::box(Vec3(2, 2, 2), Vec3(-1, -1, 5))}), 3,
      1e-9);
}

RC_GTEST_PROP(ExactGap, AgreesWithBruteForce, (std::uint64_t seed)) {
  Random random(seed);
  PackProblem problem =
      shapes::problem_of({shapes::l_shape(10, 2, 5), shapes::tetrahedron(8)}, Vec3(100, 100, 100));
  PlacedPart a{{0}, Pose::Identity(), 0};
  PlacedPart b{{1}, Pose::Identity(), 0};
  a.pose.linear() = shapes::any_rotation(random);
  b.pose.linear() = shapes::any_rotation(random);
  b.pose.translation() = shapes::any_rotation(random) * Vec3(17 + 10 * random.unit(), 0, 0);
  const double exact = check::brute_force_distance(check::placed_triangles(problem, a),
                                                   check::placed_triangles(problem, b));
  RC_PRE(exact > 0.01);
  RC_ASSERT(std::abs(least_gap_mm({transformed(problem.items[0].surface, a.pose),
                                   transformed(problem.items[1].surface, b.pose)}) -
                     exact) < 1e-6);
}

TEST(Tabu, SortsAListAndIsTheSameOnEveryRun) {
  constexpr int kCount = 9;
  Order start(kCount);
  std::iota(start.rbegin(), start.rend(), 0);
  const auto inversions = [](const Order& order) {
    double sum = 0;
    for (std::size_t i = 0; i < order.size(); ++i)
      for (std::size_t j = i + 1; j < order.size(); ++j) sum += order[i] > order[j];
    return sum;
  };
  Order at = start;
  int rounds = 0;
  OrderCost cost;
  cost.evaluate = [&](const Order& order, std::size_t first_change, double) {
    for (std::size_t i = 0; i < first_change; ++i) EXPECT_EQ(order[i], at[i]);
    return inversions(order);
  };
  cost.moved = [&](const Order& order, std::size_t) { at = order; };
  cost.go_on = [&](int) { return ++rounds < 1000; };
  const FoundOrder found = tabu_search(start, inversions(start), {3, 100, 20, 5}, cost);
  EXPECT_EQ(found.cost, 0);
  EXPECT_TRUE(std::is_sorted(found.order.begin(), found.order.end()));
  at = start;
  const FoundOrder again = tabu_search(start, inversions(start), {3, 100, 20, 5}, cost);
  EXPECT_EQ(found.order, again.order);
}

TEST(Tabu, EndsWithoutPatienceAndWithNothingToSwap) {
  OrderCost cost;
  int evaluations = 0;
  cost.evaluate = [&](const Order&, std::size_t, double) {
    ++evaluations;
    return 1.0;
  };
  cost.moved = [](const Order&, std::size_t) {};
  cost.go_on = [](int) { return true; };
  EXPECT_EQ(tabu_search({0}, 1, {3, 10, 8, 1}, cost).order, Order{0});
  EXPECT_EQ(evaluations, 0);
  EXPECT_EQ(tabu_search({0, 1, 2}, 1, {3, 0, 8, 1}, cost).cost, 1);
  EXPECT_EQ(evaluations, 0);
}

TEST(Merge, PairsFollowTheGraphAndStayWithinAModel) {
  PackProblem problem = shapes::problem_of({shapes::box(Vec3(1, 1, 1)), shapes::box(Vec3(1, 1, 1)),
                                            shapes::box(Vec3(1, 1, 1)), shapes::box(Vec3(1, 1, 1))},
                                           Vec3(10, 10, 10));
  for (PackItem& item : problem.items) item.model = 0;
  problem.items[3].model = 1;
  problem.edges = {{0, 1, 1}, {0, 2, 1}, {1, 2, 1}, {2, 3, 1}};
  using Pairs = std::vector<std::pair<int, int>>;
  EXPECT_EQ(mergeable_pairs({{0}, {1}, {2}, {3}}, problem), (Pairs{{0, 1}, {0, 2}, {1, 2}}));
  EXPECT_EQ(mergeable_pairs({{0, 1}, {2}, {3}}, problem), (Pairs{{0, 1}}));
  EXPECT_EQ(mergeable_pairs({{0, 1, 2}, {3}}, problem), Pairs{});
  EXPECT_EQ(merged({0, 4}, {1, 9}), (ItemSet{0, 1, 4, 9}));
}

TEST(Merge, NoPairShutsACavity) {
  PackProblem problem = shapes::problem_of({shapes::box(Vec3(1, 1, 1)), shapes::box(Vec3(1, 1, 1)),
                                            shapes::box(Vec3(1, 1, 1)), shapes::box(Vec3(1, 1, 1))},
                                           Vec3(10, 10, 10));
  for (PackItem& item : problem.items) item.model = 0;
  problem.edges = {{0, 1, 1}, {0, 2, 1}, {1, 2, 1}, {2, 3, 1}};
  problem.enclosures = {{0, 1, 2}, {3}};  // nothing can open a cavity inside one item
  using Pairs = std::vector<std::pair<int, int>>;
  EXPECT_EQ(mergeable_pairs({{0}, {1}, {2}, {3}}, problem),
            (Pairs{{0, 1}, {0, 2}, {1, 2}, {2, 3}}));
  EXPECT_EQ(mergeable_pairs({{0, 1}, {2}, {3}}, problem), (Pairs{{1, 2}}));
  EXPECT_EQ(mergeable_pairs({{0, 1}, {2, 3}}, problem), Pairs{});
}

}  // namespace
}  // namespace packmerger
