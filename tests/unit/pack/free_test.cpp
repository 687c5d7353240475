// Parts anywhere on their tray: the lattice, the distances, the separation and the ways out.
#include <gtest/gtest.h>

#include <rapidcheck/gtest.h>

#include "base/parallel.h"
#include "fixtures/models.h"
#include "pack/exact/exact_disassembly.h"
#include "pack/exact/exact_figures.h"
#include "pack/exact/exact_removal.h"
#include "pack/free/free_search.h"
#include "pack/free/limit_search.h"
#include "pack/free/part_shapes.h"
#include "pack/pack.h"
#include "pack/separate/compression.h"
#include "unit/pack/check.h"
#include "unit/pack/problems.h"

namespace packmerger {
namespace {

// Drawn once: that is what takes the time.
const Shape& random_shape(Random& random) {
  static const std::vector<Shape> shapes = [] {
    std::vector<Shape> made;
    for (const Mesh& mesh : shapes::solids()) made.emplace_back(mesh, 4);
    return made;
  }();
  return shapes[random.below(shapes.size())];
}

// A cube of 20 mm round a closed chamber of 14 mm.
Mesh shut_box() { return closed_mesh(fixtures::nested_cubes(20, 14)); }

double point_to_triangle(const Vec3& p, const std::array<Vec3, 3>& corner) {
  double best = check::point_distance(p, corner);
  for (std::size_t k = 0; k < 3; ++k)
    best = std::min(best, check::segment_distance(p, p, corner[k], corner[(k + 1) % 3]));
  return best;
}

double closest_triangle(const Mesh& mesh, const Vec3& p) {
  double best = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < mesh.n_triangles(); ++i)
    best = std::min(best, point_to_triangle(p, mesh.corners(i)));
  return best;
}

RC_GTEST_PROP(DistanceGrid, KnowsTheClosestPointOfATriangle, (std::uint64_t seed)) {
  Random random(seed);
  const auto point = [&random] {
    const double x = random.unit();
    const double y = random.unit();
    return Vec3(x, y, random.unit());
  };
  const std::array<Vec3, 3> triangle{point(), point(), point()};
  for (int i = 0; i < 50; ++i) {
    const Vec3 p = 3 * point() - Vec3::Constant(1);
    RC_ASSERT(std::abs(std::sqrt(squared_distance(p, triangle)) - point_to_triangle(p, triangle)) <
              1e-9);
  }
}

RC_GTEST_PROP(DistanceGrid, TellsTheDistanceToTheClosestTriangle, (std::uint64_t seed)) {
  Random random(seed);
  const Mesh mesh = shapes::random_solid(random);
  const DistanceGrid grid(mesh, 1, 3);
  const Box3 box = bounding_box(mesh);
  for (int i = 0; i < 20; ++i) {
    Vec3 point;
    for (int k = 0; k < 3; ++k)
      point[k] = box.min()[k] - 2.5 + random.unit() * (box.sizes()[k] + 5);
    const double exact = closest_triangle(mesh, point) * (check::is_inside(mesh, point) ? -1 : 1);
    Vec3f gradient = Vec3f::Zero();
    const float told = grid.at(point.cast<float>(), gradient);
    RC_ASSERT(std::abs(told - exact) < std::sqrt(3) / 2);
    RC_ASSERT(told == grid.at(point.cast<float>()));
    RC_ASSERT(gradient.norm() < 1.8F);
  }
  RC_ASSERT(grid.at(Vec3f::Constant(std::numeric_limits<float>::quiet_NaN())) ==
            DistanceGrid::kFar);
}

BitPart random_bits(Random& random, const BitGrid& grid) {
  return bit_part(random_shape(random), shapes::any_rotation(random), grid,
                  random.below(2) == 0 ? 0 : 1);
}

// What is thinner than a layer of the lattice is there all the same, wherever it lies in the part;
// a plate keeps its columns, and a closed chamber has none left.
TEST(BitPart, HoldsThinMatterAndNoClosedChamber) {
  const Shape plate(shapes::box(Vec3(15, 15, 0.5)), 3);
  for (const double limit_mm : {20., 50., 80., 100., 150.}) {
    const BitGrid grid{0.4, limit_mm / 62, 100, 100};
    const BitPart lying = bit_part(plate, Mat3::Identity(), grid, 0.025);
    EXPECT_EQ(lying.runs.size(), static_cast<std::size_t>(lying.width * lying.depth)) << limit_mm;
  }
  const Shape shut(shut_box(), 3);
  const BitPart box = bit_part(shut, Mat3::Identity(), {0.5, 0.5, 100, 100}, 0);
  EXPECT_EQ(box.runs.size(), static_cast<std::size_t>(box.width * box.depth));
}

using Matter = std::vector<std::array<bool, kHeights>>;

bool meets(const Matter& matter, const BitGrid& grid, const BitPart& part, const BitPlace& at) {
  for (const BitRun& run : part.runs)
    for (int z = run.low + at.z; z < run.high + at.z; ++z)
      if (matter[static_cast<std::size_t>((at.y + run.y) * grid.columns + at.x + run.x)]
                [static_cast<std::size_t>(z)])
        return true;
  return false;
}

// The scan of height bits against loops over single cells; what was cleared is as if it had never
// been there.
RC_GTEST_PROP(LowestPlace, IsTheLowestOfAllPlaces, (std::uint64_t seed)) {
  Random random(seed);
  const BitGrid grid{1.9, 1.3, 15 + static_cast<int>(random.below(9)), 13};
  HeightBits tray(grid);
  Matter matter(static_cast<std::size_t>(grid.columns * grid.rows));
  for (int i = 0; i < 4; ++i) {
    const BitPart part = random_bits(random, grid);
    const PlaceRating rating{20 + 30 * random.unit(), grid.unit_mm, 0.5 * random.unit(),
                             0.02 * random.unit() - 0.01, 0.02 * random.unit() - 0.01};
    RatedPlace expected{{}, 1e9};
    bool there_is_one = false;
    for (int y = 0; y + part.depth <= grid.rows; ++y)
      for (int x = 0; x + part.width <= grid.columns; ++x) {
        const std::uint64_t taken = tray.taken(part, x, y);
        for (int z = 0; z * grid.unit_mm + part.height_mm <= rating.limit_mm; ++z) {
          const bool is_taken = meets(matter, grid, part, {x, y, z});
          RC_ASSERT(is_taken == ((taken >> z & 1) != 0));
          const double rated = part.height_mm + rating.malus_mm + rating.per_row_mm * y +
                               z * grid.unit_mm + rating.per_column_mm * x;
          if (is_taken || rated >= expected.rating_mm) continue;
          expected = {{x, y, z}, rated};
          there_is_one = true;
        }
      }
    RatedPlace found{{}, 1e9};
    RC_ASSERT(lower_place(tray, part, rating, found) == there_is_one);
    if (!there_is_one) continue;
    RC_ASSERT(std::abs(found.rating_mm - expected.rating_mm) < 1e-9);
    const BitPlace& at = found.place;
    RC_ASSERT(!meets(matter, grid, part, at));
    tray.fill(part, at.x, at.y, at.z);
    if (random.below(3) == 0) {
      tray.clear(part, at.x, at.y, at.z);
      continue;
    }
    for (const BitRun& run : part.runs)
      for (int z = run.low + at.z; z < run.high + at.z; ++z)
        matter[static_cast<std::size_t>((at.y + run.y) * grid.columns + at.x + run.x)]
              [static_cast<std::size_t>(z)] = true;
  }
}

// The gradient is the energy's, by differences.
RC_GTEST_PROP(Overlap, FallsAgainstItsGradient, (std::uint64_t seed)) {
  Random random(seed);
  const Shape& one = random_shape(random);
  const Shape& other = random_shape(random);
  const std::vector<const Shape*> both{&one, &other};
  std::vector<Pose> poses(2, Pose::Identity());
  for (Pose& pose : poses) {
    pose.linear() = shapes::any_rotation(random);
    for (int k = 0; k < 3; ++k) pose.translation()[k] = 6 + 8 * random.unit();
  }
  const Vec3 box_mm(20, 20, 20);
  const Rooms rooms(2, 0.5);
  const Overlap here = overlap(both, poses, box_mm, rooms);
  if (here.gradient.norm() < 1) return;
  const Eigen::VectorXd step = -1e-3 * here.gradient.normalized();
  const Overlap next = overlap(both, moved(both, poses, step), box_mm, rooms);
  RC_ASSERT(next.energy < here.energy);
}

// Slivers have few samples, triangles that vanish none that is no number.
TEST(Shape, SamplesByAreaAndKeepsItsMeasure) {
  const double hair = 1e-19;
  TriangleSoup wedge;
  wedge.points = {{hair, 0, 0}, {0, hair, 0}, {0, 0, hair},
                  {150, 0, 0},  {0, 0.02, 0}, {0, 0, 0.02}};
  wedge.triangles = {{0, 2, 1}, {3, 4, 5}, {0, 1, 4}, {0, 4, 3},
                     {1, 2, 5}, {1, 5, 4}, {2, 0, 3}, {2, 3, 5}};
  const Shape thin(closed_mesh(wedge), 20);
  std::size_t samples = 0;
  for (const SampleBall& ball : thin.balls) {
    samples += ball.samples.size();
    for (const Vec3f& sample : ball.samples) EXPECT_TRUE(sample.allFinite());
  }
  EXPECT_LT(samples, 200U);
  // Where the distances reach far the grid is coarser instead of larger.
  const Shape far(shapes::box(Vec3(20, 20, 20)), 40);
  const Vec3f cells =
      (far.distances.high() - far.distances.low()) / static_cast<float>(far.distances.pitch_mm());
  EXPECT_LT(cells.maxCoeff(), 85);
}

TEST(Separation, MovesPartsApartThatOverlapALittle) {
  const Shape ball(shapes::sphere(6, 16), 3);
  const Shape cube(shapes::box(Vec3(10, 10, 10)), 3);
  std::vector<Pose> poses(3, Pose::Identity());
  poses[0].translation() = Vec3(6, 6, 6.2);
  poses[1].translation() = Vec3(16, 7, 5);
  poses[2].translation() = Vec3(16, 16, 5.5);
  const Separation separation({&ball, &cube, &cube}, Vec2(30, 30), 1, [] { return false; });
  ASSERT_TRUE(separation.separate(poses, 13, 200));
  EXPECT_LE(separation.height_mm(poses), 13);
  std::vector<Mesh> placed{transformed(ball.mesh, poses[0]), transformed(cube.mesh, poses[1]),
                           transformed(cube.mesh, poses[2])};
  EXPECT_GE(least_gap_mm(placed), 1);
  for (const Mesh& mesh : placed) EXPECT_GE(bounding_box(mesh).min().minCoeff(), 0);
  const std::vector<Pose> before = poses;
  EXPECT_FALSE(separation.separate(poses, 9, 200)) << "a cube is higher";
  for (std::size_t i = 0; i < poses.size(); ++i) EXPECT_EQ(poses[i].matrix(), before[i].matrix());
}

// A cube on a slope of air: compression lets it down, the judge's limit is kept.
TEST(Compression, GoesBackToTheLastLayoutThatWasAccepted) {
  const Shape cube(shapes::box(Vec3(10, 10, 10)), 3);
  std::vector<Pose> poses(2, Pose::Identity());
  poses[0].translation() = Vec3(6, 6, 6);
  poses[1].translation() = Vec3(20, 20, 14);
  const Separation separation({&cube, &cube}, Vec2(30, 30), 0, [] { return false; });
  Random random(1);
  std::vector<Pose> free = poses;
  compress(
      separation, free, 8, [] { return false; }, [](const auto&, double) { return true; }, random);
  EXPECT_LT(separation.height_mm(free), 10.3);
  compress(
      separation, poses, 8, [] { return false; },
      [](const auto&, double height_mm) { return height_mm > 15; }, random);
  EXPECT_GT(separation.height_mm(poses), 15);
  EXPECT_LT(separation.height_mm(poses), 15.6);
}

// A ball under an upturned cup comes out after it, a cube in the clasp of a U is drawn out of it,
// and a ball in a closed box never comes out.
TEST(ExactDisassembly, FindsOrderPathsAndWhatIsStuck) {
  const auto at = [](const Mesh& mesh, const Vec3& low) {
    return transformed(mesh, Pose(Eigen::Translation3d(Vec3(low - bounding_box(mesh).min()))));
  };
  const Vec2 base_mm(60, 60);
  const Mesh cup =
      at(shapes::turned(shapes::cup(10, 15, 2),
                        Eigen::AngleAxisd(std::numbers::pi, Vec3::UnitX()).toRotationMatrix()),
         Vec3(5, 5, 0));
  const Mesh ball = at(shapes::sphere(4, 12), Vec3(11, 11, 1));
  const ExactDisassembly lifted = exact_disassembly({ball, cup}, base_mm, {});
  EXPECT_EQ(lifted.order, (std::vector<int>{1, 0}));
  EXPECT_TRUE(lifted.stuck.empty());
  EXPECT_TRUE(lifted.paths[0].empty() && lifted.paths[1].empty());

  // A U on its side, open to the right, and a cube between its legs.
  const Mesh u = shapes::extruded(
      {{0, 0}, {5, 0}, {25, 0}, {30, 0}, {30, 20}, {25, 20}, {25, 5}, {5, 5}, {5, 20}, {0, 20}},
      {{0, 1, 7, 8, 9}, {1, 2, 6, 7}, {3, 4, 5, 6, 2}}, 10);
  const auto quarter = [](const Vec3& axis) {
    return Eigen::AngleAxisd(std::numbers::pi / 2, axis).toRotationMatrix();
  };
  const std::vector<Mesh> clasped{
      at(shapes::turned(u, quarter(Vec3::UnitY()) * quarter(Vec3::UnitX())), Vec3(5, 5, 0)),
      at(shapes::box(Vec3(10, 8, 10)), Vec3(12, 6, 6))};
  const ExactDisassembly drawn = exact_disassembly(clasped, base_mm, {});
  EXPECT_TRUE(drawn.stuck.empty());
  EXPECT_FALSE(drawn.paths[0].empty() && drawn.paths[1].empty());
  EXPECT_FALSE(first_obstacle(clasped, drawn.order, drawn.paths, {}));
  EXPECT_TRUE(first_obstacle(clasped, drawn.order, {{}, {}}, {}));

  const ExactDisassembly none = exact_disassembly(
      {at(shut_box(), Vec3(5, 5, 0)), at(shapes::sphere(4, 12), Vec3(11, 11, 5))}, base_mm, {});
  EXPECT_EQ(none.stuck, (std::vector<int>{0, 1}));
}

// A plan that was made for other poses may lead through the plate or over the side.
TEST(ExactRemoval, PathsStayOverTheBase) {
  const Mesh box = shapes::box(Vec3(10, 10, 10));
  const Vec3 low(2, 2, 0.3);
  const Mesh cube =
      transformed(box, Pose(Eigen::Translation3d(Vec3(low - bounding_box(box).min()))));
  const Progress progress;
  const StandingParts alone({cube}, progress);
  const Vec2 base_mm(20, 20);
  const auto stays = [&](const std::vector<Vec3>& path) {
    return stay_over_base(alone, {path}, base_mm);
  };
  EXPECT_TRUE(stays({}));
  EXPECT_TRUE(stays({{0, 0, -0.2}, {8, 0, 0}, {-10, 0, 5}}));
  EXPECT_FALSE(stays({{0, 0, -0.5}, {0, 0, 1}}));
  EXPECT_FALSE(stays({{8.5, 0, 0}, {-8.5, 0, 0}}));
  EXPECT_FALSE(stays({{0, -2.5, 1}}));
}

TEST(ExactDisassembly, EndsWhenItIsToldTo) {
  const auto at = [](const Mesh& mesh, const Vec3& low) {
    return transformed(mesh, Pose(Eigen::Translation3d(Vec3(low - bounding_box(mesh).min()))));
  };
  const Progress progress;
  const StandingParts shut(
      {at(shut_box(), Vec3(5, 5, 0)), at(shapes::sphere(4, 12), Vec3(11, 11, 5))}, progress);
  int looks = 0;
  const ExactDisassembly plan =
      exact_disassembly(shut, Vec2(60, 60), Plate(), [&looks] { return ++looks > 20; });
  EXPECT_EQ(plan.stuck.size(), 2U);
  EXPECT_LT(looks, 30);
}

TEST(LimitSearch, EndsWhileItStillDraws) {
  std::vector<Shape> made;
  for (int i = 0; i < 6; ++i) made.emplace_back(shapes::box(Vec3(6 + i, 5, 4)), 3);
  FreeParts parts;
  std::vector<Pose> start(made.size(), Pose::Identity());
  for (std::size_t i = 0; i < made.size(); ++i) {
    parts.shapes.push_back(&made[i]);
    start[i].translation() = Vec3(8, 8, 3 + 6. * static_cast<double>(i));
  }
  Random random(1);
  for (int i = 0; i < 24; ++i) parts.rotations.push_back(shapes::any_rotation(random));
  std::atomic<int> looks = 0;
  Effort effort;
  LimitSearch search(
      parts, Vec2(20, 20), Plate(), 0.5, start, 40, 1, [&looks] { return ++looks > 5; }, effort);
  EXPECT_FALSE(search.next([] { return false; }));
  EXPECT_LT(looks, 100);
}

TEST(PartShapes, HearThatTheyAreCancelled) {
  const PackProblem problem = shapes::problem_of({shapes::sphere(6, 12)}, Vec3(20, 20, 20));
  std::atomic<bool> cancelled = false;
  Pace pace(Progress({}, &cancelled), 0);
  cancelled = true;
  EXPECT_THROW(shapes_of(problem, {{{0}, Pose::Identity(), 0}}, pace), Error);
}

// One part above the other.
Packing stacked(const PackProblem& problem) {
  Packing packing;
  double top_mm = 0;
  for (int i = 0; i < static_cast<int>(problem.items.size()); ++i) {
    PlacedPart part{{i}, Pose::Identity(), 0};
    const Box3 box = bounding_box(part_mesh(problem, part));
    part.pose.translation() = Vec3(0, 0, top_mm) - box.min();
    top_mm += box.sizes().z() + problem.gap_mm;
    packing.parts.push_back(part);
    packing.removal_order.insert(packing.removal_order.begin(), i);
  }
  packing.removal_paths.resize(packing.parts.size());
  measure(problem, packing);
  return packing;
}

// Every tray keeps what pack.h promises, and is no higher than without the search.
TEST(FreeSearch, KeepsWhatIsPromised) {
  for (std::uint64_t seed = 1; seed <= 2; ++seed) {
    Random random(seed);
    std::vector<Mesh> meshes;
    for (int i = 0; i < 6; ++i) meshes.push_back(shapes::random_solid(random));
    PackProblem problem =
        shapes::low_problem(std::move(meshes), Vec3(30, 30, 80), seed % 2 == 0 ? 0 : 0.6);
    problem.seed = seed;
    const Packing free = pack(problem, {});
    check::expect_valid(problem, free, 0.25);
    problem.anywhere = false;
    EXPECT_LE(free.cost, pack(problem, {}).cost);
  }
}

TEST(FreeSearch, KeepsWhatIsPromisedOnSeveralTrays) {
  std::vector<Mesh> meshes;
  for (int i = 0; i < 2; ++i)
    for (const Mesh& mesh : shapes::solids()) meshes.push_back(mesh);
  const PackProblem problem = shapes::low_problem(std::move(meshes), Vec3(24, 24, 18), 0.5);
  const Packing packing = pack(problem, {});
  EXPECT_GT(packing.trays.size(), 1U);
  check::expect_valid(problem, packing, 0.25);
}

TEST(FreeSearch, IsTheSameOnOneThreadAndOnTwo) {
  Random random(5);
  std::vector<Mesh> meshes;
  for (int i = 0; i < 6; ++i) meshes.push_back(shapes::random_solid(random));
  PackProblem problem = shapes::low_problem(std::move(meshes), Vec3(28, 28, 80), 0.4);
  const Packing two = pack(problem, {});
  const ThreadLimit limit(1);
  const Packing one = pack(problem, {});
  check::expect_same(one, two);
}

// A search that always finds something better ends by the work that it did, which grows with the
// number of parts and not with what remains to be found.
TEST(FreeSearch, EndsWithoutABudgetHoweverManyPartsThereAre) {
  std::vector<Mesh> meshes;
  for (int i = 0; i < 40; ++i) meshes.push_back(shapes::box(Vec3(7 + 0.05 * i, 6, 4)));
  PackProblem problem = shapes::low_problem(std::move(meshes), Vec3(40, 40, 300), 0.4);
  problem.tabu_patience = 2;
  Pace pace({}, 0);
  Effort effort;
  EXPECT_TRUE(searched_freely(problem, stacked(problem), pace, effort));
  EXPECT_LT(effort.spent(), 1'500'000'000U);
}

// The chamber would be the lowest place that there is.
TEST(FreeSearch, EndsWhereTheLowestPlaceHasNoWayOut) {
  const PackProblem problem =
      shapes::low_problem({shut_box(), shapes::box(Vec3(6, 6, 6))}, Vec3(22, 22, 40), 0);
  const Packing packing = pack(problem, {});
  check::expect_valid(problem, packing, 0.25);
  EXPECT_GT(packing.trays[0].size_mm.z(), 25);
}

TEST(FreeSearch, FindsALowerTrayThanDropping) {
  std::vector<Mesh> meshes;
  for (int i = 0; i < 3; ++i) meshes.push_back(shapes::cup(9, 16, 2, 16));
  for (int i = 0; i < 3; ++i) meshes.push_back(shapes::sphere(6, 12));
  for (int i = 0; i < 4; ++i) meshes.push_back(shapes::l_shape(18, 5, 9));
  PackProblem problem = shapes::low_problem(std::move(meshes), Vec3(40, 40, 90), 0);
  const Packing free = pack(problem, {});
  check::expect_valid(problem, free, 0.25);
  problem.anywhere = false;
  EXPECT_LT(free.cost, 0.95 * pack(problem, {}).cost);
}

}  // namespace
}  // namespace packmerger
