#include "shape/surface/unite_bodies.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "fixtures/models.h"
#include "shape/read/soup.h"
#include "shape/surface/repair.h"

namespace packmerger {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

struct United {
  TriangleSoup soup;
  std::vector<std::string> codes;
  double volume_mm3 = 0;
};

// The way of a model that is loaded; what repair() has to say is left out.
United unite(const TriangleSoup& model) {
  Warnings of_repair;
  Warnings warnings;
  const Mesh mesh = unite_bodies(repair(model, of_repair, Progress()), warnings, Progress());
  United united{to_soup(mesh), {}, volume_mm3(mesh)};
  for (const Warning& warning : warnings) united.codes.push_back(warning.code);
  return united;
}

TriangleSoup cube_at(const Vec3& corner, double side_mm) {
  return fixtures::box(corner, corner + Vec3::Constant(side_mm));
}

TEST(UniteBodies, WhatOverlapsCountsOnce) {
  const United two =
      unite(fixtures::together(cube_at(Vec3(0, 0, 0), 40), cube_at(Vec3(20, 20, 20), 40)));
  EXPECT_NEAR(two.volume_mm3, 120000, 1);
  EXPECT_THAT(two.codes, ElementsAre("shape_changed"));
  EXPECT_EQ(components_of(two.soup).count, 1);
  EXPECT_TRUE(is_closed_manifold(two.soup));

  const TriangleSoup cross =
      fixtures::together(fixtures::together(fixtures::box(Vec3(-30, -5, -5), Vec3(30, 5, 5)),
                                            fixtures::box(Vec3(-5, -30, -5), Vec3(5, 30, 5))),
                         fixtures::box(Vec3(-5, -5, -30), Vec3(5, 5, 30)));
  EXPECT_NEAR(unite(cross).volume_mm3, 3 * 6000 - 2 * 1000, 1);
}

TEST(UniteBodies, LittleInCommonIsNoDoubt) {
  const United two =
      unite(fixtures::together(cube_at(Vec3(0, 0, 0), 40), cube_at(Vec3(39.9, 39.9, 10), 40)));
  EXPECT_NEAR(two.volume_mm3, 128000, 1e-3);
  EXPECT_THAT(two.codes, IsEmpty()) << "less than is worth a word";
  const United more =
      unite(fixtures::together(cube_at(Vec3(0, 0, 0), 40), cube_at(Vec3(39, 39, 10), 40)));
  EXPECT_NEAR(more.volume_mm3, 128000 - 30, 1e-3);
  EXPECT_THAT(more.codes, ElementsAre("united"));
}

TEST(UniteBodies, CavitiesStayAndWhatReachesIntoThemIsMatter) {
  const TriangleSoup hollow =
      fixtures::together(fixtures::cube(40), fixtures::reversed(cube_at(Vec3(10, 10, 10), 20)));
  const United pierced =
      unite(fixtures::together(hollow, fixtures::box(Vec3(18, 18, -10), Vec3(22, 22, 20))));
  // 10 mm of the rod are outside, 10 in the wall, 10 in the cavity
  EXPECT_NEAR(pierced.volume_mm3, 64000 - 8000 + 2 * 160, 1e-3);
  EXPECT_THAT(pierced.codes, ElementsAre("shape_changed"));
}

TEST(UniteBodies, ABodyThatCrossesItselfIsNoException) {
  // A prism over a star that is drawn in one go: its middle is wound around twice.
  TriangleSoup star;
  for (const double z : {0.0, 10.0})
    for (int i = 0; i < 5; ++i) {
      const double angle = 2 * std::numbers::pi * (2 * i % 5) / 5;
      star.points.emplace_back(20 * std::cos(angle), 20 * std::sin(angle), z);
    }
  star.points.emplace_back(0, 0, 0);
  star.points.emplace_back(0, 0, 10);
  for (int i = 0; i < 5; ++i) {
    const int j = (i + 1) % 5;
    star.triangles.push_back({10, j, i});
    star.triangles.push_back({11, 5 + i, 5 + j});
    star.triangles.push_back({i, j, 5 + j});
    star.triangles.push_back({i, 5 + j, 5 + i});
  }
  const double once = 10 * 1.12257 * 20 * 20;  // a pentagram's area of its radius squared
  const United united = unite(star);
  EXPECT_NEAR(united.volume_mm3, once, 0.001 * once);
  EXPECT_THAT(united.codes, ElementsAre("shape_changed"));
}

TEST(UniteBodies, WhatStandsApartOrOnlyTouchesKeepsItsBytes) {
  for (const TriangleSoup& model :
       {fixtures::together(cube_at(Vec3(0, 0, 0), 10), cube_at(Vec3(11, 0, 0), 10)),
        fixtures::together(cube_at(Vec3(0, 0, 0), 10), cube_at(Vec3(10, 3, 3), 10)),
        fixtures::nested_cubes(20, 10), fixtures::sphere(10, 2)}) {
    Warnings warnings;
    const Mesh mesh = repair(model, warnings, Progress());
    const United united = unite(model);
    EXPECT_EQ(united.soup.points, mesh.points());
    EXPECT_EQ(united.soup.triangles, mesh.triangles());
    EXPECT_THAT(united.codes, IsEmpty());
  }
}

}  // namespace
}  // namespace packmerger
