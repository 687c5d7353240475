#include "printers/layers/layer_extents.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "base/parallel.h"
#include "model/mesh.h"
#include "printers/layers/layers.h"
#include "printers/layers/slice_layers.h"
#include "shapes.h"

namespace packmerger {
namespace {

using printed::box;
using printed::moved;

constexpr double kNoSupport = 1.5707963267948966;  // rad: only a ceiling would need it

LayerExtents extents(const std::vector<Mesh>& parts, double layer_mm, double angle = 0) {
  std::vector<const Mesh*> pointers;
  for (const Mesh& part : parts) pointers.push_back(&part);
  return layer_extents(pointers, layer_mm, angle);
}

TEST(LayerCount, ForgivesRounding) {
  EXPECT_EQ(layer_count(0, 0.2), 0);
  EXPECT_EQ(layer_count(-1, 0.2), 0);
  EXPECT_EQ(layer_count(56, 0.2), 280);
  EXPECT_EQ(layer_count(56.1, 0.2), 281);
  EXPECT_EQ(layer_count(0.01, 0.2), 1);
  EXPECT_EQ(layer_count(80, 0.028), 2858);
}

TEST(LayerExtents, Box) {
  const LayerExtents layers = extents({box(Vec3(5, 6, 0), Vec3(15, 26, 3))}, 0.5);
  ASSERT_EQ(layers.size(), 6U);
  for (const auto& layer : layers) {
    EXPECT_NEAR((layer.min() - Vec2(5, 6)).norm(), 0, 1e-9);
    EXPECT_NEAR((layer.max() - Vec2(15, 26)).norm(), 0, 1e-9);
  }
}

TEST(LayerExtents, AreThoseOfTheOutlines) {
  EXPECT_TRUE(rc::check([] {
    const double height_mm = *rc::gen::inRange(10, 60);
    Mesh mesh = closed_mesh(fixtures::blob(height_mm, 3));
    const Vec3 axis = Vec3(*rc::gen::inRange(-5, 6), *rc::gen::inRange(-5, 6), 1).normalized();
    const double turn = *rc::gen::inRange(0, 360) * 0.01745;
    Pose pose = Pose::Identity();
    pose.linear() = Eigen::AngleAxisd(turn, axis).toRotationMatrix();
    mesh = transformed(mesh, pose);
    mesh = moved(mesh, Vec3(80, 80, -bounding_box(mesh).min().z()));
    const double layer_mm = *rc::gen::inRange(1, 20) * 0.1;
    const LayerExtents found = extents({mesh}, layer_mm, kNoSupport);
    const std::vector<Layer> layers = slice_layers({&mesh}, layer_mm);
    RC_ASSERT(found.size() == layers.size());
    for (std::size_t i = 0; i < layers.size(); ++i) {
      Eigen::AlignedBox2d outlines;
      for (const Contour& contour : layers[i].contours) outlines.extend(contour.box);
      RC_ASSERT(found[i].isEmpty() == outlines.isEmpty());
      if (outlines.isEmpty()) continue;
      RC_ASSERT((found[i].min() - outlines.min()).norm() < 1e-9);
      RC_ASSERT((found[i].max() - outlines.max()).norm() < 1e-9);
    }
  }));
}

TEST(LayerExtents, IncludeSupport) {
  // a slab on one leg: support reaches below all of the slab
  const Mesh mesh = printed::from_cells({0, 10, 60}, {0, 10, 40}, {0, 8, 10},
                                        [](int x, int y, int z) { return z == 1 || x + y == 0; });
  const LayerExtents without = extents({mesh}, 1, radians(90));
  EXPECT_NEAR(without[3].sizes().x(), 10, 1e-9);
  const LayerExtents with = extents({mesh}, 1, 0);
  EXPECT_NEAR(with[3].sizes().x(), 60, 0.5);
  EXPECT_NEAR(with[3].sizes().y(), 40, 0.5);
  EXPECT_NEAR(with[9].sizes().x(), 60, 1e-9);
}

TEST(LayerExtents, ALayerMayHoldSupportOnlyOrNothing) {
  const Mesh high = box(Vec3(0, 0, 5), Vec3(20, 10, 6));
  const LayerExtents layers = extents({high}, 1, 0);
  ASSERT_EQ(layers.size(), 6U);
  EXPECT_NEAR(layers[0].sizes().x(), 20, 1e-6);
  EXPECT_TRUE(extents({high}, 1, radians(90))[0].isEmpty());
}

TEST(LayerExtents, ThreadsDoNotMatter) {
  const Mesh a = moved(closed_mesh(fixtures::blob(30, 3)), Vec3(30, 30, 20));
  const Mesh b = moved(closed_mesh(fixtures::torus(15, 5, 40, 20)), Vec3(90, 30, 5));
  const LayerExtents many = extents({a, b}, 0.5);
  const ThreadLimit limit(1);
  const LayerExtents one = extents({a, b}, 0.5);
  ASSERT_EQ(many.size(), one.size());
  for (std::size_t i = 0; i < many.size(); ++i) {
    EXPECT_EQ(many[i].min(), one[i].min());
    EXPECT_EQ(many[i].max(), one[i].max());
  }
}

}  // namespace
}  // namespace packmerger
