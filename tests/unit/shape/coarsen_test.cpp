#include "shape/surface/coarsen.h"

#include <algorithm>
#include <atomic>

#include <gtest/gtest.h>

#include "base/error.h"
#include "fixtures/models.h"
#include "shape/surface/surface_query.h"

namespace packmerger {
namespace {

long euler_number(const Mesh& mesh) {
  return static_cast<long>(mesh.n_points()) - static_cast<long>(mesh.n_triangles()) / 2;
}

double longest_edge_mm(const Mesh& mesh) {
  double longest = 0;
  for (const auto& t : mesh.triangles())
    for (std::size_t i = 0; i < 3; ++i)
      longest = std::max(longest, (mesh.points()[static_cast<std::size_t>(t[i])] -
                                   mesh.points()[static_cast<std::size_t>(t[(i + 1) % 3])])
                                      .norm());
  return longest;
}

TEST(Coarsen, KeepsShapeAndTopologyOnFewerTriangles) {
  for (const TriangleSoup& soup :
       {fixtures::sphere(20, 5), fixtures::torus(20, 6, 160, 60),
        fixtures::together(fixtures::sphere(20, 4), fixtures::reversed(fixtures::sphere(15, 4)))}) {
    const Mesh fine = closed_mesh(soup);
    const Mesh coarse = coarsened(fine, 0.09, 6, {});
    EXPECT_LT(coarse.n_triangles(), fine.n_triangles() / 4);
    EXPECT_EQ(euler_number(coarse), euler_number(fine));
    EXPECT_LT(longest_edge_mm(coarse), 2.5 * 6);
    EXPECT_NEAR(volume_mm3(coarse), volume_mm3(fine), 0.05 * volume_mm3(fine));
    const SurfaceQuery old(fine);
    for (const auto& [a, b, c] : coarse.triangles()) {
      const Vec3 middle = (coarse.points()[static_cast<std::size_t>(a)] +
                           coarse.points()[static_cast<std::size_t>(b)] +
                           coarse.points()[static_cast<std::size_t>(c)]) /
                          3;
      EXPECT_LT(old.distance_mm(middle), 1);
    }
  }
}

TEST(Coarsen, OfABoxLeavesItsCornersAndTriangulatesItsSides) {
  // Flat sides cost nothing, and the edges of a box are never left.
  TriangleSoup soup = fixtures::cube(20);
  const Mesh fine = closed_mesh(soup);
  const Mesh coarse = coarsened(fine, 0.01, 100, {});
  EXPECT_EQ(coarse.n_points(), 8U);
  EXPECT_NEAR(volume_mm3(coarse), 8000, 1e-6);
}

TEST(Coarsen, CanBeCancelled) {
  std::atomic<bool> cancelled = true;
  const Mesh fine = closed_mesh(fixtures::sphere(20, 3));
  EXPECT_THROW(coarsened(fine, 0.1, 6, Progress({}, &cancelled)), Error);
}

}  // namespace
}  // namespace packmerger
