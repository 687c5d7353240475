#include "shape/solid/refine.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "fixtures/models.h"
#include "shape/read/soup.h"

namespace packmerger {
namespace {

double longest_edge(const TriangleSoup& soup) {
  double longest = 0;
  for (const auto& t : soup.triangles)
    for (int i = 0; i < 3; ++i)
      longest = std::max(longest, (soup.points[t[i]] - soup.points[t[(i + 1) % 3]]).norm());
  return longest;
}

// A box of six tetrahedra around its diagonal.
TetMesh box_of_six(const Vec3& size) {
  TetMesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.points.emplace_back(i & 1 ? size.x() : 0, i & 2 ? size.y() : 0, i & 4 ? size.z() : 0);
  mesh.tetrahedra = {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7},
                     {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}};
  mesh.sides.assign(
      6, {FaceSide::kOutside, FaceSide::kOutside, FaceSide::kOutside, FaceSide::kOutside});
  link_neighbours(mesh);
  for (int t = 0; t < 6; ++t)  // the face at z = 0 plays the cavity
    for (int face = 0; face < 4; ++face) {
      const auto corners = face_corners(mesh, t, face);
      if (std::all_of(corners.begin(), corners.end(), [](int c) { return c < 4; }))
        mesh.sides[t][face] = FaceSide::kCavity;
    }
  return mesh;
}

double area(const TetMesh& mesh, FaceSide side) {
  double sum = 0;
  for (int t = 0; t < mesh.count(); ++t)
    for (int face = 0; face < 4; ++face) {
      if (mesh.sides[t][face] != side) continue;
      const auto [a, b, c] = face_corners(mesh, t, face);
      sum += (mesh.points[b] - mesh.points[a]).cross(mesh.points[c] - mesh.points[a]).norm() / 2;
    }
  return sum;
}

TEST(SplitLongEdges, KeepsShapePointsAndMarkers) {
  const TriangleSoup cube = fixtures::cube(10);
  TriangleSoup soup = cube;
  std::vector<int> markers(soup.triangles.size(), 1);
  markers[0] = markers[1] = 2;  // the bottom
  split_long_edges(soup, markers, 1.5);
  EXPECT_LE(longest_edge(soup), 1.5);
  EXPECT_TRUE(is_closed_manifold(soup));
  EXPECT_NEAR(signed_volume_mm3(soup), 1000, 1e-9);
  for (std::size_t i = 0; i < cube.points.size(); ++i) EXPECT_EQ(soup.points[i], cube.points[i]);
  ASSERT_EQ(markers.size(), soup.triangles.size());
  for (std::size_t i = 0; i < markers.size(); ++i) {
    const auto& t = soup.triangles[i];
    const bool at_bottom =
        std::all_of(t.begin(), t.end(), [&](int c) { return soup.points[c].z() == 0; });
    EXPECT_EQ(markers[i], at_bottom ? 2 : 1);
  }
}

TEST(SplitLongEdges, LeavesShortEdgesAlone) {
  TriangleSoup soup = fixtures::sphere(10, 2);
  std::vector<int> markers(soup.triangles.size(), 1);
  const std::size_t count = soup.triangles.size();
  split_long_edges(soup, markers, 100);
  EXPECT_EQ(soup.triangles.size(), count);
}

TEST(SplitLargeTetrahedra, IsConformingAndKeepsVolumeAndSides) {
  RC_ASSERT(rc::check("any box, any limit", [] {
    const Vec3 size(*rc::gen::inRange(1, 30), *rc::gen::inRange(1, 30), *rc::gen::inRange(1, 30));
    const double limit = size.prod() / *rc::gen::inRange(7, 3000);
    TetMesh mesh = box_of_six(size);
    split_large_tetrahedra(mesh, limit);
    for (int t = 0; t < mesh.count(); ++t) {
      RC_ASSERT(mesh.volume_mm3(t) > 0);
      RC_ASSERT(mesh.volume_mm3(t) <= limit);
      for (int face = 0; face < 4; ++face)
        RC_ASSERT((mesh.neighbours[t][face] < 0) == (mesh.sides[t][face] != FaceSide::kInterior));
    }
    RC_ASSERT(std::abs(total_volume_mm3(mesh) - size.prod()) < 1e-9 * size.prod());
    const double bottom = size.x() * size.y();
    const double all = 2 * (bottom + size.y() * size.z() + size.z() * size.x());
    // A hanging point would leave faces without a partner and raise these areas.
    RC_ASSERT(std::abs(area(mesh, FaceSide::kCavity) - bottom) < 1e-9 * all);
    RC_ASSERT(std::abs(area(mesh, FaceSide::kOutside) - (all - bottom)) < 1e-9 * all);
  }));
}

}  // namespace
}  // namespace packmerger
