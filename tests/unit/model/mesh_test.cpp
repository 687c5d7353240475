// What a Mesh promises, and what is refused.
#include "model/mesh.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <string>

#include "base/error.h"
#include "fixtures/fault_of.h"
#include "fixtures/models.h"

namespace packmerger {
namespace {

using testing::HasSubstr;

std::string refusal(const TriangleSoup& soup) {
  return fixtures::refusal_of([&] { closed_mesh(soup); });
}

TEST(Mesh, KeepsTheOrderOfThePointsThatAreUsed) {
  TriangleSoup soup = fixtures::sphere(10, 2);
  const TriangleSoup plain = soup;
  soup.points.insert(soup.points.begin() + 7, Vec3(1, 2, 3));
  for (auto& triangle : soup.triangles)
    for (int& corner : triangle) corner += corner >= 7 ? 1 : 0;
  const Mesh mesh = closed_mesh(soup);
  EXPECT_EQ(mesh.points(), plain.points);
  EXPECT_EQ(mesh.triangles(), plain.triangles);
}

TEST(Mesh, NeighboursShareTheEdgeTheOtherWayRound) {
  const Mesh mesh = closed_mesh(fixtures::torus(20, 5, 24, 12));
  for (std::size_t i = 0; i < mesh.n_triangles(); ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      const int from = mesh.triangles()[i][k];
      const int to = mesh.triangles()[i][(k + 1) % 3];
      const auto& other = mesh.triangles()[static_cast<std::size_t>(mesh.neighbours()[i][k])];
      const auto at = std::find(other.begin(), other.end(), to) - other.begin();
      ASSERT_LT(at, 3);
      EXPECT_EQ(other[static_cast<std::size_t>((at + 1) % 3)], from);
    }
}

TEST(Mesh, CopiesAreSharedAndMovedOnesShareTheTriangles) {
  const Mesh mesh = closed_mesh(fixtures::cube(10));
  const Mesh copy = mesh;
  EXPECT_EQ(&copy.points(), &mesh.points());
  const Mesh moved = transformed(mesh, Pose(Eigen::Translation3d(1, 2, 3)));
  EXPECT_EQ(&moved.triangles(), &mesh.triangles());
  EXPECT_EQ(moved.points().front(), mesh.points().front() + Vec3(1, 2, 3));
  EXPECT_EQ(mesh.points(), fixtures::cube(10).points) << "the first one stays";
}

TEST(Mesh, ABorderIsNoNeighbourAndNotClosed) {
  TriangleSoup soup = fixtures::cube(10);
  soup.triangles.pop_back();
  const Mesh open = manifold_mesh(soup);
  EXPECT_FALSE(open.is_closed());
  const std::array<int, 3> missing = fixtures::cube(10).triangles.back();
  int borders = 0;
  for (int face = 0; face < static_cast<int>(open.n_triangles()); ++face)
    for (std::size_t k = 0; k < 3; ++k) {
      const int from = open.triangles()[face][k];
      const int to = open.triangles()[face][(k + 1) % 3];
      const int beside = open.neighbours()[face][k];
      if (beside < 0) {
        ++borders;  // the missing triangle has the edge the other way round
        int there = 0;
        for (std::size_t i = 0; i < 3; ++i)
          there += missing[i] == to && missing[(i + 1) % 3] == from;
        EXPECT_EQ(there, 1);
        continue;
      }
      const auto& back = open.neighbours()[beside];
      EXPECT_EQ(std::count(back.begin(), back.end(), face), 1);
    }
  EXPECT_EQ(borders, 3);
  const Mesh whole = closed_mesh(fixtures::cube(10));
  EXPECT_FALSE(united({&whole, &open}).is_closed()) << "closed where all are";
  EXPECT_THROW(whole.with_points({Vec3::Zero()}), Error);
  EXPECT_THAT(refusal(soup), HasSubstr("it has holes"));
}

TEST(Mesh, WhatIsNo2ManifoldIsRefused) {
  TriangleSoup doubled = fixtures::cube(10);
  doubled.triangles.push_back(doubled.triangles.front());
  EXPECT_THAT(refusal(doubled), HasSubstr("not a closed 2-manifold"));

  TriangleSoup fin;  // three sheets on one edge
  fin.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}};
  fin.triangles = {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}};
  EXPECT_THAT(refusal(fin), HasSubstr("an edge has more than two sides"));

  TriangleSoup collapsed = fixtures::cube(10);
  collapsed.triangles[3][1] = collapsed.triangles[3][0];
  EXPECT_THAT(refusal(collapsed), HasSubstr("a triangle has a corner twice"));

  // two cubes that share a corner, one point for both
  TriangleSoup touching = fixtures::cube(10);
  const TriangleSoup other = fixtures::box(Vec3::Constant(-10), Vec3::Zero());
  const auto origin = [](const TriangleSoup& soup) {
    return static_cast<int>(std::find(soup.points.begin(), soup.points.end(), Vec3(0, 0, 0)) -
                            soup.points.begin());
  };
  const int base = static_cast<int>(touching.points.size());
  const int shared = origin(touching);
  touching.points.insert(touching.points.end(), other.points.begin(), other.points.end());
  for (auto triangle : other.triangles) {
    for (int& corner : triangle) corner = corner == origin(other) ? shared : corner + base;
    touching.triangles.push_back(triangle);
  }
  EXPECT_THAT(refusal(touching), HasSubstr("two sheets touch at a vertex"));
}

TEST(Mesh, AUnionKeepsEveryPieceAsItWas) {
  const Mesh one = closed_mesh(fixtures::cube(10));
  const Mesh two = closed_mesh(fixtures::box(Vec3(20, 0, 0), Vec3(25, 5, 5)));
  const Mesh both = united({&one, &two});
  EXPECT_TRUE(both.is_closed());
  EXPECT_NEAR(volume_mm3(both), 1000 + 125, 1e-9);
  EXPECT_EQ(both.neighbours(), closed_mesh(to_soup(both)).neighbours());
  EXPECT_TRUE(united({}).empty());
}

}  // namespace
}  // namespace packmerger
