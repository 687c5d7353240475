#include "printers/layers/support_volume.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <numbers>
#include <numeric>

#include "base/parallel.h"
#include "shapes.h"

namespace packmerger {
namespace {

using printed::box;

double support(const std::vector<Mesh>& parts, double angle_deg = 0) {
  std::vector<const Mesh*> pointers;
  for (const Mesh& part : parts) pointers.push_back(&part);
  return support_volume_mm3(pointers, radians(angle_deg));
}

// The same along fewer lines, for properties that are checked a hundred times.
double coarse_support(const std::vector<Mesh>& parts, int lines) {
  std::vector<const Mesh*> pointers;
  for (const Mesh& part : parts) pointers.push_back(&part);
  const SupportGrid grid = support_grid(pointers, lines);
  std::vector<double> rows(grid.rows, 0.0);
  for_each_support_row(pointers, grid, 0, [&](int row, const std::vector<SupportSpan>& spans) {
    for (const SupportSpan& span : spans) rows[row] += span.high_mm - span.low_mm;
  });
  return std::accumulate(rows.begin(), rows.end(), 0.0) * grid.cell_mm.prod();
}

TEST(SupportVolume, NothingNeedsNone) {
  EXPECT_EQ(support({}), 0);
  EXPECT_EQ(support({Mesh()}), 0);
}

TEST(SupportVolume, WhatStandsOnThePlateNeedsNone) {
  EXPECT_EQ(support({box(Vec3(3, 4, 0), Vec3(13, 24, 30))}), 0);
}

TEST(SupportVolume, BelowABoxInTheAir) {
  EXPECT_NEAR(support({box(Vec3(3, 4, 7), Vec3(13, 24, 30))}), 10 * 20 * 7, 1e-6);
}

TEST(SupportVolume, EndsAtTheFirstMatterBelow) {
  const Mesh low = box(Vec3(0, 0, 0), Vec3(10, 10, 4));
  const Mesh high = box(Vec3(0, 0, 9), Vec3(10, 10, 12));
  EXPECT_NEAR(support({low, high}), 100 * 5, 1e-6);
  EXPECT_NEAR(support({high, low}), 100 * 5, 1e-6);
}

TEST(SupportVolume, PartsThatTouchOrOverlapAreOneMatter) {
  const Mesh low = box(Vec3(0, 0, 0), Vec3(10, 10, 5));
  EXPECT_NEAR(support({low, box(Vec3(0, 0, 5), Vec3(10, 10, 9))}), 0, 1e-9);
  EXPECT_NEAR(support({low, box(Vec3(0, 0, 3), Vec3(10, 10, 9))}), 0, 1e-9);
  // inside one another: the inner facets lie in matter
  EXPECT_NEAR(support({low, box(Vec3(2, 2, 1), Vec3(8, 8, 4))}), 0, 1e-9);
}

TEST(SupportVolume, SphereOnThePlate) {
  const double r = 30;
  const double exact = std::numbers::pi * r * r * r / 3;
  EXPECT_NEAR(support({printed::resting_sphere(r)}), exact, exact * 5e-4);
}

TEST(SupportVolume, SphereAtFortyFiveDegreesNeedsItsCapAlone) {
  // facets below the 45° circle: a disc of radius r/√2 over a spherical cap
  const double r = 30;
  const double a = r / std::numbers::sqrt2;
  const double exact = std::numbers::pi * a * a * r -
                       2 * std::numbers::pi / 3 * (r * r * r - std::pow(r * r - a * a, 1.5));
  EXPECT_NEAR(support({printed::resting_sphere(r)}, 45), exact, exact * 0.02);
}

TEST(SupportVolume, Table) {
  const Mesh table = printed::table(72, 56, 5, 7, Vec3(10, 20, 0));
  const double exact = (72.0 * 72 - 4 * 49) * 51;
  EXPECT_NEAR(support({table}), exact, exact * 2e-3);
  EXPECT_NEAR(support({table}, 45), exact, exact * 2e-3);
}

TEST(SupportVolume, CavityIsFilledToItsRoof) {
  const Mesh shell = printed::moved(closed_mesh(fixtures::nested_cubes(40, 20)), Vec3(20, 20, 20));
  const double lifted = bounding_box(shell).min().z();
  const double below = std::max(0.0, lifted) * 40 * 40;
  EXPECT_NEAR(support({shell}), 20 * 20 * 20 + below, 30);
}

TEST(SupportVolume, NestedCoversShareTheirSupport) {
  const Mesh outer = printed::cover(Vec3(30, 30, 20), 2, Vec3(0, 0, 0));
  const Mesh inner = printed::cover(Vec3(24, 24, 16), 2, Vec3(3, 3, 0));
  EXPECT_NEAR(support({outer}), 26 * 26 * 18, 40);
  EXPECT_NEAR(support({inner}), 20 * 20 * 14, 30);
  // the outer one's emptiness less the whole of the inner one, plus the inner one's own
  EXPECT_NEAR(support({outer, inner}), 26 * 26 * 18 - 24 * 24 * 16 + 20 * 20 * 14, 60);
}

TEST(SupportVolume, AFacetAtTheAngleItselfNeedsNone) {
  // an inverted frustum whose sides overhang by 45° exactly
  const Mesh mesh = printed::frustum(10, 30, 10, Vec3(50, 50, 0));
  EXPECT_NEAR(support({mesh}, 45), 0, 1e-9);
  const double under = 30 * 30 * 10 - 10.0 / 3 * (100 + 900 + 300);
  EXPECT_NEAR(support({mesh}, 44.9), under, under * 2e-3);
  EXPECT_NEAR(support({mesh}, 0), under, under * 2e-3);
  EXPECT_EQ(support({mesh}, 90), 0);
}

TEST(SupportVolume, WhatLiesBelowThePlateCountsForNothing) {
  EXPECT_EQ(support({box(Vec3(0, 0, -5), Vec3(10, 10, 5))}), 0);
  EXPECT_NEAR(support({box(Vec3(0, 0, -9), Vec3(10, 10, -3)), box(Vec3(0, 0, 4), Vec3(10, 10, 5))}),
              400, 1e-6);
}

TEST(SupportVolume, MeasuresTheInterfaceToo) {
  const Mesh table = printed::table(72, 56, 5, 7, Vec3(10, 20, 0));
  const SupportMeasure measure = support_measure({&table}, 0);
  EXPECT_NEAR(measure.interface_mm2, 72 * 72 - 4 * 49, 20);
}

TEST(SupportVolume, SameBytesOnAnyNumberOfThreads) {
  const Mesh blob = printed::moved(closed_mesh(fixtures::blob(60, 4)), Vec3(50, 50, 40));
  const double many = support_volume_mm3({&blob}, 0.3);
  const ThreadLimit one(1);
  EXPECT_EQ(many, support_volume_mm3({&blob}, 0.3));
}

TEST(SupportVolume, ScalesWithTheCubeOfSizeAndIgnoresPlace) {
  EXPECT_TRUE(rc::check([] {
    const double scale = *rc::gen::inRange(1, 50) * 0.13;
    const Vec3 by(*rc::gen::inRange(-500, 500) * 0.37, *rc::gen::inRange(-500, 500) * 0.41, 0);
    const double turn = *rc::gen::inRange(0, 360);
    const Mesh model = printed::moved(closed_mesh(fixtures::blob(20, 2)), Vec3(0, 0, 15));
    Pose pose = Pose::Identity();
    pose.translate(by);
    pose.rotate(Eigen::AngleAxisd(radians(turn), Vec3::UnitZ()));
    const Mesh larger = printed::scaled(transformed(model, pose), scale);
    const double expected = coarse_support({model}, 1 << 14) * scale * scale * scale;
    RC_ASSERT(std::abs(coarse_support({larger}, 1 << 14) - expected) <= 5e-3 * expected);
  }));
}

TEST(SupportVolume, PartsApartAddUp) {
  EXPECT_TRUE(rc::check([] {
    std::vector<Mesh> parts;
    double sum = 0;
    const int count = *rc::gen::inRange(1, 6);
    for (int i = 0; i < count; ++i) {
      const double z = *rc::gen::inRange(0, 30);
      parts.push_back(
          printed::moved(closed_mesh(fixtures::sphere(8, 3)), Vec3(20 * i, 7 * i, z + 8)));
      sum += coarse_support({parts.back()}, 1 << 12);
    }
    RC_ASSERT(std::abs(coarse_support(parts, 1 << 14) - sum) <= 2e-2 * sum);
  }));
}

// Whole-numbered boxes, counted column by column of unit squares.
TEST(SupportVolume, AgreesWithCountingOverRandomBoxes) {
  EXPECT_TRUE(rc::check([] {
    constexpr int kSide = 8;
    constexpr int kHeight = 12;
    std::array<std::array<std::array<bool, kHeight>, kSide>, kSide> matter{};
    std::vector<Mesh> parts;
    parts.push_back(box(Vec3(0, 0, 0), Vec3(kSide, kSide, 0.0 + 1)));  // so that the frame is fixed
    for (int x = 0; x < kSide; ++x)
      for (int y = 0; y < kSide; ++y) matter[x][y][0] = true;
    const int count = *rc::gen::inRange(1, 8);
    for (int i = 0; i < count; ++i) {
      const auto span = [](int size) {
        const int low = *rc::gen::inRange(0, size - 1);
        return std::pair{low, *rc::gen::inRange(low + 1, size + 1)};
      };
      const auto [x0, x1] = span(kSide);
      const auto [y0, y1] = span(kSide);
      const auto [z0, z1] = span(kHeight);
      parts.push_back(box(Vec3(x0, y0, z0), Vec3(x1, y1, z1)));
      for (int x = x0; x < x1; ++x)
        for (int y = y0; y < y1; ++y)
          for (int z = z0; z < z1; ++z) matter[x][y][z] = true;
    }
    int empty = 0;
    for (const auto& plane : matter)
      for (const auto& column : plane) {
        int top = 0;
        for (int z = 0; z < kHeight; ++z)
          if (column[z]) top = z + 1;
        for (int z = 0; z < top; ++z) empty += column[z] ? 0 : 1;
      }
    RC_ASSERT(std::abs(coarse_support(parts, 1 << 14) - empty) <= 1e-6 * (1 + empty));
  }));
}

TEST(SupportVolume, RealBunny) {
  PACKMERGER_TEST_MODEL(bunny, "stanford-bunny.obj");
  TriangleSoup standing = printed::with_holes_filled(bunny);
  for (Vec3& p : standing.points) p = Vec3(p.x(), -p.z(), p.y());
  const Mesh bunny_mesh = closed_mesh(standing);
  const Box3 at = bounding_box(bunny_mesh);
  const Mesh mesh = printed::scaled(printed::moved(bunny_mesh, -at.min()), 100 / at.sizes().z());
  // 81.6 cm³ by a column count of another make
  EXPECT_NEAR(support({mesh}), 81600, 81600 * 0.02);
}

}  // namespace
}  // namespace packmerger
