// Cavities that powder does not come out of.
#include "shape/solid/pockets.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "fixtures/models.h"

namespace packmerger {
namespace {

// A surface of revolution about z: a closed loop of (radius, height), counter-clockwise with the
// radius to the right, none of it on the axis.
Mesh ring(const std::vector<Vec2>& loop) {
  constexpr int kSides = 48;
  const int count = static_cast<int>(loop.size());
  TriangleSoup soup;
  for (int side = 0; side < kSides; ++side) {
    const double angle = 2 * std::numbers::pi * side / kSides;
    for (const Vec2& at : loop)
      soup.points.emplace_back(at.x() * std::cos(angle), at.x() * std::sin(angle), at.y());
  }
  for (int side = 0; side < kSides; ++side)
    for (int i = 0; i < count; ++i) {
      const int next = (i + 1) % count;
      const int a = side * count + i, b = side * count + next;
      const int c = (side + 1) % kSides * count + next, d = (side + 1) % kSides * count + i;
      soup.triangles.push_back({a, c, b});
      soup.triangles.push_back({a, d, c});
    }
  return closed_mesh(soup);
}

// A drum with a hole through each of its ends.
Mesh drum(double lower_mm, double upper_mm) {
  const double low = lower_mm / 2;
  const double up = upper_mm / 2;
  return ring({{low, 0}, {15, 0}, {15, 30}, {up, 30}, {up, 27}, {12, 27}, {12, 3}, {low, 3}});
}

std::size_t keeping(const Mesh& mesh) { return keeping_cavities(mesh, 5, Progress()); }

TEST(KeepingCavities, HaveNoTwoOpenings) {
  EXPECT_GT(volume_mm3(drum(6, 6)), 0);
  EXPECT_EQ(sealed_cavities(drum(4, 4)), 0U);
  EXPECT_EQ(keeping(drum(4, 4)), 1U);
  EXPECT_EQ(keeping(drum(4, 6.5)), 1U);
  EXPECT_EQ(keeping(drum(6.5, 6.5)), 0U);
  EXPECT_EQ(keeping(drum(4, 12)), 0U) << "one is wide enough for two";
}

TEST(KeepingCavities, MayBeSealedAndSmall) {
  const Mesh small = closed_mesh(fixtures::nested_cubes(20, 3));
  EXPECT_EQ(sealed_cavities(small), 1U);
  EXPECT_EQ(keeping(small), 1U);
}

TEST(KeepingCavities, AreNoneInWhatIsSolidOrOpen) {
  EXPECT_EQ(keeping(closed_mesh(fixtures::cube(20))), 0U);
  EXPECT_EQ(keeping(closed_mesh(fixtures::torus(15, 5, 48, 24))), 0U);
}

}  // namespace
}  // namespace packmerger
