// Parts in cavities and under overhangs, and their ways out, where money counts.

#include <gtest/gtest.h>

#include <rapidcheck/gtest.h>

#include "base/parallel.h"
#include "fixtures/block_solid.h"
#include "pack/pack.h"
#include "unit/pack/check.h"
#include "unit/pack/problems.h"

namespace packmerger {
namespace {

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
  EXPECT_LT(packing.trays.at(0).size_mm.prod(), 30 * 30 * 24 + 50);
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
      EXPECT_NEAR(packing.cost, house_mm3, 1e-3 * house_mm3);
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
  check::expect_same(one, two);
}

}  // namespace
}  // namespace packmerger
