#include "printers/layers/slice_layers.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <numbers>

#include "base/parallel.h"
#include "shapes.h"

namespace packmerger {
namespace {

using printed::box;
using printed::moved;

std::vector<Layer> cut(const std::vector<Mesh>& parts, double layer_mm) {
  std::vector<const Mesh*> pointers;
  for (const Mesh& part : parts) pointers.push_back(&part);
  return slice_layers(pointers, layer_mm);
}

TEST(SliceLayers, NothingHasNone) {
  EXPECT_TRUE(cut({}, 0.2).empty());
  EXPECT_TRUE(cut({Mesh()}, 0.2).empty());
}

TEST(SliceLayers, Box) {
  const std::vector<Layer> layers = cut({box(Vec3(5, 6, 0), Vec3(15, 26, 3))}, 0.5);
  ASSERT_EQ(layers.size(), 6U);
  for (const Layer& layer : layers) {
    ASSERT_EQ(layer.contours.size(), 1U);
    EXPECT_NEAR(layer.area_mm2, 200, 1e-9);
    EXPECT_NEAR(layer.perimeter_mm, 60, 1e-9);
  }
}

TEST(SliceLayers, CornersInTheCuttingPlaneCloseContours) {
  // planes at 0.5, 1.5, …: corners and whole facets lie in them
  const Mesh mesh = printed::from_cells({0, 10, 20}, {0, 10}, {0, 0.5, 1.5, 4},
                                        [](int x, int, int z) { return x == 0 || z == 1; });
  const std::vector<Layer> layers = cut({mesh}, 1);
  ASSERT_EQ(layers.size(), 4U);
  for (const Layer& layer : layers) ASSERT_EQ(layer.contours.size(), 1U);
  EXPECT_NEAR(layers[0].area_mm2, 100, 1e-9);  // a corner in the plane counts as above it
  EXPECT_NEAR(layers[1].area_mm2, 200, 1e-9);
  EXPECT_NEAR(layers[2].area_mm2, 100, 1e-9);
}

TEST(SliceLayers, HolesCountNegative) {
  const Mesh cover = printed::cover(Vec3(30, 20, 10), 2, Vec3(0, 0, 0));
  const Layer layer = cut({cover}, 1)[3];
  ASSERT_EQ(layer.contours.size(), 2U);
  const auto [hole, outline] = std::minmax(layer.contours[0].area_mm2, layer.contours[1].area_mm2);
  EXPECT_NEAR(outline, 600, 1e-9);
  EXPECT_NEAR(hole, -26 * 16, 1e-9);
  EXPECT_NEAR(layer.perimeter_mm, 2 * 50 + 2 * 42, 1e-9);
}

TEST(SliceLayers, VolumeIsAreaByHeight) {
  for (const TriangleSoup& soup :
       {fixtures::sphere(20, 4), fixtures::torus(20, 7, 60, 30), fixtures::blob(40, 4)}) {
    Mesh mesh = closed_mesh(soup);
    mesh = moved(mesh, Vec3(50, 50, -bounding_box(mesh).min().z()));
    double volume = 0;
    for (const Layer& layer : cut({mesh}, 0.1)) volume += layer.area_mm2 * 0.1;
    EXPECT_NEAR(volume, volume_mm3(mesh), 2e-3 * volume_mm3(mesh));
  }
}

TEST(SliceLayers, OneHeightIsCutAsItsLayerIs) {
  Mesh mesh = closed_mesh(fixtures::blob(30, 3));
  mesh = moved(mesh, Vec3(30, 30, -bounding_box(mesh).min().z()));
  const std::vector<Layer> layers = cut({mesh}, 0.5);
  for (std::size_t i = 0; i < layers.size(); ++i) {
    const Layer one = slice_at(mesh, (static_cast<double>(i) + 0.5) * 0.5);
    EXPECT_EQ(one.contours.size(), layers[i].contours.size());
    EXPECT_EQ(one.area_mm2, layers[i].area_mm2);
    EXPECT_EQ(one.perimeter_mm, layers[i].perimeter_mm);
  }
}

TEST(SliceLayers, PartsAddUpAndThreadsDoNotMatter) {
  const Mesh a = moved(closed_mesh(fixtures::blob(30, 3)), Vec3(30, 30, 20));
  const Mesh b = moved(closed_mesh(fixtures::torus(15, 5, 40, 20)), Vec3(90, 30, 5));
  const std::vector<Layer> both = cut({a, b}, 0.5);
  const std::vector<Layer> only_a = cut({a}, 0.5);
  const std::vector<Layer> only_b = cut({b}, 0.5);
  for (std::size_t i = 0; i < both.size(); ++i) {
    const double sum =
        (i < only_a.size() ? only_a[i].area_mm2 : 0) + (i < only_b.size() ? only_b[i].area_mm2 : 0);
    EXPECT_NEAR(both[i].area_mm2, sum, 1e-9);
  }
  const ThreadLimit one(1);
  const std::vector<Layer> again = cut({a, b}, 0.5);
  for (std::size_t i = 0; i < both.size(); ++i) {
    EXPECT_EQ(both[i].area_mm2, again[i].area_mm2);
    EXPECT_EQ(both[i].perimeter_mm, again[i].perimeter_mm);
  }
}

}  // namespace
}  // namespace packmerger
