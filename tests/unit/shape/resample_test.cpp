#include "shape/surface/resample.h"

#include <gtest/gtest.h>

#include "base/error.h"
#include "base/parallel.h"
#include "fixtures/models.h"
#include "shape/read/soup.h"
#include "shape/surface/repair.h"
#include "shape/surface/surface_query.h"

namespace packmerger {
namespace {

TriangleSoup crossing_balls() {
  TriangleSoup second = fixtures::sphere(10, 3);
  for (Vec3& point : second.points) point += Vec3(12, 3, 1);
  return fixtures::together(fixtures::sphere(10, 3), second);
}

void expect_clean(const Resampled& resampled, double tolerance) {
  EXPECT_TRUE(is_closed_manifold(resampled.surface));
  EXPECT_FALSE(self_intersects(resampled.surface));
  EXPECT_LE(resampled.deviation_mm, tolerance);
}

TEST(Resample, UnitesWhatOverlaps) {
  const TriangleSoup model = crossing_balls();
  const Resampled resampled = resample(closed_mesh(model), 0.3, Progress());
  expect_clean(resampled, 0.3);
  EXPECT_EQ(components_of(resampled.surface).count, 1);
  EXPECT_GT(volume_mm3(resampled.surface), 4000);
  EXPECT_LT(volume_mm3(resampled.surface), signed_volume_mm3(model)) << "the overlap counts once";
  const SurfaceQuery query(model);
  for (const Vec3& point : resampled.surface.points()) EXPECT_LE(query.distance_mm(point), 0.3);
}

TEST(Resample, SharpEdgesStayWithinTheTolerance) {
  TriangleSoup other = fixtures::cube(15);
  for (Vec3& point : other.points) point += Vec3(7, 8, 9);
  const Resampled resampled =
      resample(closed_mesh(fixtures::together(fixtures::cube(15), other)), 0.2, Progress());
  expect_clean(resampled, 0.2);
  EXPECT_NEAR(volume_mm3(resampled.surface), 2 * 3375 - 8 * 7 * 6, 40);
}

TEST(Resample, SameBytesOnOneAndTwoThreads) {
  const Mesh model = closed_mesh(crossing_balls());
  const auto with_threads = [&](std::size_t threads) {
    const ThreadLimit limit(threads);
    return resample(model, 0.4, Progress()).surface;
  };
  const Mesh one = with_threads(1);
  const Mesh two = with_threads(2);
  EXPECT_EQ(one.points(), two.points());
  EXPECT_EQ(one.triangles(), two.triangles());
}

TEST(Resample, KeepsTheTrianglesThatDoNotCross) {
  const TriangleSoup model = crossing_balls();
  const Resampled resampled = resample(closed_mesh(model), 0.3, Progress());
  EXPECT_LT(resampled.deviation_mm, 1e-3);
  EXPECT_LT(resampled.surface.n_triangles(), 2 * model.triangles.size());
}

TEST(ResampleOnGrid, IsTheFallBack) {
  TriangleSoup other = fixtures::cube(15);
  for (Vec3& point : other.points) point += Vec3(7, 8, 9);
  double volume = 0;
  for (const TriangleSoup& model : {crossing_balls(), fixtures::together(fixtures::cube(15), other),
                                    fixtures::nested_cubes(20, 10)}) {
    const Resampled resampled = resample_on_grid(closed_mesh(model), 0.5, Progress());
    expect_clean(resampled, 0.5);
    volume = volume_mm3(resampled.surface);
  }
  EXPECT_NEAR(volume, 7000, 70) << "the cavity of the last one is kept";
}

TEST(ResampleOnGrid, RefusesAToleranceOutOfReach) {
  EXPECT_THROW(resample_on_grid(closed_mesh(crossing_balls()), 1e-4, Progress()), Error);
}

TEST(ResampleOnGrid, SameBytesOnOneAndTwoThreads) {
  const Mesh model = closed_mesh(crossing_balls());
  const auto with_threads = [&](std::size_t threads) {
    const ThreadLimit limit(threads);
    return resample_on_grid(model, 0.4, Progress()).surface;
  };
  const Mesh one = with_threads(1);
  const Mesh two = with_threads(2);
  EXPECT_EQ(one.points(), two.points());
  EXPECT_EQ(one.triangles(), two.triangles());
}

}  // namespace
}  // namespace packmerger
