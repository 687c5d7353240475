// Depth maps and pictures against analytic shapes.
#include "offscreen/offscreen.h"

#include <cmath>
#include <thread>

#include <gtest/gtest.h>

#include "fixtures/z_buffer.h"
#include "unit/pack/shapes.h"

namespace packmerger {
namespace {

DepthTriangles triangles_of(const Mesh& mesh) { return shapes::depth_triangles(mesh); }

TEST(Depth, BoxIsFlatAndNothingAroundIt) {
  const Mesh box = shapes::box(Vec3(10, 20, 5), Vec3(3, 4, 7));
  const RayLattice rays{0.5, 0.5, 1, 20, 30};
  DepthRenderer renderer;
  const DepthMap above = renderer.from_above(triangles_of(box), rays);
  const DepthMap below = renderer.from_below(triangles_of(box), rays);
  for (int j = 0; j < rays.height; ++j)
    for (int i = 0; i < rays.width; ++i) {
      const double x = rays.x_mm + i;
      const double y = rays.y_mm + j;
      const std::size_t at = static_cast<std::size_t>(j * rays.width + i);
      const bool inside = x > 3 && x < 13 && y > 4 && y < 24;
      ASSERT_EQ(above.heights[at] != kNothingBelow, inside) << x << " " << y;
      ASSERT_EQ(below.heights[at] != kNothingAbove, inside);
      if (inside) {
        ASSERT_NEAR(above.heights[at], 12, 1e-4);
        ASSERT_NEAR(below.heights[at], 7, 1e-4);
      }
    }
}

TEST(Depth, SphereFollowsItsFormulaOnSurfacesOfAnySize) {
  const Mesh sphere = shapes::sphere(20, 64);
  DepthRenderer renderer;
  for (const double step : {2.0, 0.25, 1.0}) {  // the surface grows, then is used again
    const int count = static_cast<int>(50 / step);
    const RayLattice rays{-25 + step / 2, -25 + step / 2, step, count, count};
    const DepthMap above = renderer.from_above(triangles_of(sphere), rays);
    const DepthMap below = renderer.from_below(triangles_of(sphere), rays);
    for (int j = 0; j < count; ++j)
      for (int i = 0; i < count; ++i) {
        const double x = rays.x_mm + i * step;
        const double y = rays.y_mm + j * step;
        const std::size_t at = static_cast<std::size_t>(j * count + i);
        if (x * x + y * y > 20.01 * 20.01) {
          ASSERT_EQ(above.heights[at], kNothingBelow);
        }
        if (x * x + y * y < 18 * 18) {
          const double z = std::sqrt(400 - x * x - y * y);
          ASSERT_NEAR(above.heights[at], z, 0.15);
          ASSERT_NEAR(below.heights[at], -z, 0.15);
        }
      }
  }
}

TEST(Depth, NoTrianglesHitNothing) {
  DepthRenderer renderer;
  const DepthMap map = renderer.from_above({}, {0, 0, 1, 4, 3});
  EXPECT_EQ(map.heights, std::vector<float>(12, kNothingBelow));
}

TEST(Depth, ManyThreadsDrawTheSame) {
  const Mesh sphere = shapes::sphere(10, 32);
  const RayLattice rays{-12, -12, 0.5, 49, 49};
  std::vector<DepthMap> maps(4);
  std::vector<std::thread> threads;
  for (DepthMap& map : maps)
    threads.emplace_back([&map, &sphere, &rays] {
      DepthRenderer renderer;
      for (int i = 0; i < 5; ++i) map = renderer.from_above(triangles_of(sphere), rays);
    });
  for (std::thread& thread : threads) thread.join();
  for (const DepthMap& map : maps) EXPECT_EQ(map.heights, maps.front().heights);
}

TEST(Draw, MeshHidesWhatLiesBehindItAndTheBackgroundStays) {
  const Mesh red = shapes::box(Vec3(10, 10, 10), Vec3(-5, -5, -5));
  const Mesh green = shapes::box(Vec3(10, 10, 10), Vec3(-5, 30, -5));
  Scene scene;
  scene.meshes = {{green, {0, 1, 0}}, {red, {1, 0, 0}}};
  scene.background = {0, 0, 1};
  scene.lines = {{Vec3(-20, -10, 12), Vec3(20, -10, 12), {0, 0, 0}}};
  Camera camera;
  camera.eye = Vec3(0, -80, 0);
  const Image image = draw(scene, camera, 120, 90, 2);
  ASSERT_EQ(image.rgba.size(), 120U * 90U * 4U);
  const auto at = [&](int x, int y) {
    return &image.rgba[static_cast<std::size_t>(4 * (y * 120 + x))];
  };
  EXPECT_GT(at(60, 45)[0], 100);
  EXPECT_EQ(at(60, 45)[1], 0);
  EXPECT_EQ(at(2, 2)[2], 255);
  int dark = 0;  // the line lies in the upper half, above the box
  for (int y = 0; y < 45; ++y) dark += at(60, y)[2] < 128 && at(60, y)[0] < 64;
  EXPECT_GT(dark, 0);
}

TEST(Draw, CameraShowsTheWholeBox) {
  const Mesh box = shapes::box(Vec3(30, 20, 60), Vec3(100, 50, 0));
  Scene scene;
  scene.meshes = {{box, {1, 0, 0}}};
  for (const Vec3& direction : {Vec3(1, 2, -1), Vec3(0, 0, -1), Vec3(-1, 0.2, 0.4)})
    for (const double aspect : {0.5, 2.0}) {
      const int height = 100;
      const int width = static_cast<int>(height * aspect);
      const Image image =
          draw(scene, camera_looking_at(bounding_box(box), direction, aspect), width, height, 1);
      int seen = 0;
      for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
          const bool hit = image.rgba[static_cast<std::size_t>(4 * (y * width + x) + 1)] < 255;
          seen += hit;
          if (x == 0 || y == 0 || x == width - 1 || y == height - 1) {
            EXPECT_FALSE(hit);
          }
        }
      EXPECT_GT(seen, width * height / 12);
    }
}

}  // namespace
}  // namespace packmerger
