#include "shape/repair.h"

#include <algorithm>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "base/error.h"
#include "fixtures/models.h"
#include "shape/soup.h"
#include "shape/surface_query.h"

namespace packmerger {
namespace {

using fixtures::together;
using testing::HasSubstr;

struct Repaired {
  Mesh mesh;
  std::string text;  // of the warning; empty without one
};

Repaired repaired(const TriangleSoup& soup) {
  Warnings warnings;
  Repaired result{repair(soup, warnings, Progress()), ""};
  EXPECT_LE(warnings.size(), 1u);
  for (const Warning& warning : warnings) {
    EXPECT_EQ(warning.code, "repaired");
    result.text = warning.text;
  }
  EXPECT_TRUE(is_closed_manifold(to_soup(result.mesh)));
  return result;
}

TriangleSoup moved(TriangleSoup soup, const Vec3& by) {
  for (Vec3& point : soup.points) point += by;
  return soup;
}

// Every triangle with three points of its own, as STL has them.
TriangleSoup exploded(const TriangleSoup& soup) {
  TriangleSoup result;
  for (const auto& triangle : soup.triangles) {
    const int base = static_cast<int>(result.points.size());
    for (const int corner : triangle) result.points.push_back(soup.points[corner]);
    result.triangles.push_back({base, base + 1, base + 2});
  }
  return result;
}

std::string refusal(const TriangleSoup& soup) {
  try {
    Warnings warnings;
    repair(soup, warnings, Progress());
  } catch (const Error& error) {
    EXPECT_EQ(error.fault(), Fault::kBadInput);
    EXPECT_FALSE(error.hint().empty());
    return error.what();
  }
  ADD_FAILURE() << "was accepted";
  return "";
}

TEST(Repair, CleanInputPassesUnchanged) {
  for (const TriangleSoup& model :
       {fixtures::cube(10), fixtures::sphere(10, 3), fixtures::torus(20, 5, 24, 12),
        fixtures::nested_cubes(20, 8),
        together(fixtures::cube(5), moved(fixtures::cube(5), {9, 0, 0}))}) {
    const Repaired result = repaired(model);
    EXPECT_EQ(result.text, "");
    const TriangleSoup out = to_soup(result.mesh);
    ASSERT_EQ(out.points.size(), model.points.size());
    for (std::size_t i = 0; i < out.points.size(); ++i) EXPECT_EQ(out.points[i], model.points[i]);
    ASSERT_EQ(out.triangles.size(), model.triangles.size());
    for (std::size_t i = 0; i < out.triangles.size(); ++i) {
      auto rotated = out.triangles[i];
      std::rotate(rotated.begin(), std::find(rotated.begin(), rotated.end(), model.triangles[i][0]),
                  rotated.end());
      EXPECT_EQ(rotated, model.triangles[i]);
    }
  }
}

TEST(Repair, WeldsEqualPointsWithoutAWarning) {
  const Repaired result = repaired(exploded(fixtures::sphere(10, 2)));
  EXPECT_EQ(result.text, "");
  EXPECT_EQ(result.mesh.n_vertices(), fixtures::sphere(10, 2).points.size());
}

TEST(Repair, ClosesCracksOfSinglePrecision) {
  TriangleSoup soup = exploded(fixtures::sphere(10, 2));
  for (std::size_t i = 0; i < soup.points.size(); ++i)
    soup.points[i].x() += 1e-6 * (static_cast<double>(i % 7) - 3);
  const Repaired result = repaired(soup);
  EXPECT_THAT(result.text, HasSubstr(" mended"));
  EXPECT_EQ(result.mesh.n_faces(), soup.triangles.size());
}

TEST(Repair, TurnsInsideOut) {
  const Repaired result = repaired(fixtures::reversed(fixtures::cube(10)));
  EXPECT_NEAR(volume_mm3(result.mesh), 1000, 1e-9);
  EXPECT_THAT(result.text, HasSubstr("12 facets turned round"));
}

TEST(Repair, TurnsSingleTriangles) {
  TriangleSoup soup = fixtures::sphere(10, 1);
  for (const int i : {3, 20, 41}) std::swap(soup.triangles[i][0], soup.triangles[i][1]);
  const Repaired result = repaired(soup);
  EXPECT_THAT(result.text, HasSubstr("3 facets turned round"));
  EXPECT_GT(volume_mm3(result.mesh), 0);
}

TEST(Repair, ComponentsInsideOthersAreCavities) {
  // Both cubes outwards, both inwards: the inner one is a cavity either way.
  const TriangleSoup inner = fixtures::box(Vec3::Constant(6), Vec3::Constant(14));
  const TriangleSoup both = together(fixtures::cube(20), inner);
  EXPECT_NEAR(volume_mm3(repaired(both).mesh), 8000 - 512, 1e-9);
  EXPECT_NEAR(volume_mm3(repaired(fixtures::reversed(both)).mesh), 8000 - 512, 1e-9);
}

TEST(Repair, FillsHoles) {
  TriangleSoup soup = fixtures::cube(10);
  soup.triangles.erase(soup.triangles.begin() + 3);                          // of the top
  soup.triangles.erase(soup.triangles.begin(), soup.triangles.begin() + 2);  // the bottom
  const Repaired result = repaired(soup);
  EXPECT_NEAR(volume_mm3(result.mesh), 1000, 1e-9);
  EXPECT_THAT(result.text, HasSubstr("2 holes filled"));
  EXPECT_THAT(result.text, HasSubstr("3 facets added"));
  EXPECT_THAT(result.text, HasSubstr(" open edges"));
}

TEST(Repair, DropsDegenerateDoubledAndLooseTriangles) {
  TriangleSoup soup = fixtures::sphere(10, 2);
  soup.triangles.push_back(soup.triangles[5]);
  soup.triangles.push_back({0, 0, 1});
  soup.points.insert(soup.points.end(), {{20, 0, 0}, {20.1, 0, 0}, {20, 0.1, 0}});
  const int base = static_cast<int>(soup.points.size()) - 3;
  soup.triangles.push_back({base, base + 1, base + 2});
  const Repaired result = repaired(soup);
  EXPECT_EQ(result.mesh.n_faces(), 320u);
  EXPECT_THAT(result.text, HasSubstr("1 facet without area"));
  EXPECT_THAT(result.text, HasSubstr("2 facets removed"));
}

TEST(Repair, RemovesAWallBetweenTwoBodies) {
  const TriangleSoup a = fixtures::box({0, 0, 0}, {10, 10, 10});
  TriangleSoup b = fixtures::box({10, 0, 0}, {20, 10, 10});
  // Its near wall is cut along the same diagonal.
  for (auto& triangle : b.triangles) {
    if (triangle == std::array{0, 4, 2})
      triangle = {0, 4, 6};
    else if (triangle == std::array{2, 4, 6})
      triangle = {0, 6, 2};
  }
  const Repaired result = repaired(together(a, b));
  EXPECT_NEAR(volume_mm3(result.mesh), 2000, 1e-9);
}

TEST(Repair, BodiesThatShareAnEdgeBecomeTwoSheets) {
  const TriangleSoup soup =
      together(fixtures::box({0, 0, 0}, {10, 10, 10}), fixtures::box({10, 10, 0}, {20, 20, 10}));
  const Repaired result = repaired(soup);
  EXPECT_NEAR(volume_mm3(result.mesh), 2000, 1e-9);
  EXPECT_TRUE(self_intersects(result.mesh));
}

TEST(Repair, RefusesWhatEnclosesNothing) {
  TriangleSoup sheet;
  sheet.points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  sheet.triangles = {{0, 1, 2}, {0, 2, 3}};
  EXPECT_THAT(refusal(sheet), HasSubstr("No closed surface"));
  refusal(TriangleSoup());
  TriangleSoup flat = fixtures::cube(10);
  for (Vec3& point : flat.points) point.z() = 0;
  refusal(flat);
}

TEST(Repair, SelfIntersectionIsSeen) {
  EXPECT_FALSE(self_intersects(closed_mesh(fixtures::sphere(10, 3))));
  EXPECT_FALSE(self_intersects(closed_mesh(fixtures::nested_cubes(20, 5))));
  EXPECT_TRUE(self_intersects(
      closed_mesh(together(fixtures::cube(10), moved(fixtures::cube(10), {3, 4, 5})))));
}

TEST(Repair, RandomDamageIsMendedOrRefused) {
  const TriangleSoup whole = fixtures::blob(50, 3);
  const double volume = signed_volume_mm3(whole);
  RC_ASSERT(rc::check("damage is mended", [&] {
    TriangleSoup soup = whole;
    const int losses = *rc::gen::inRange(0, 30);
    for (int i = 0; i < losses; ++i) {
      const auto at = *rc::gen::inRange<std::size_t>(0, soup.triangles.size());
      if (*rc::gen::arbitrary<bool>())
        std::swap(soup.triangles[at][1], soup.triangles[at][2]);
      else
        soup.triangles.erase(soup.triangles.begin() + static_cast<std::ptrdiff_t>(at));
    }
    Warnings warnings;
    const Mesh mesh = repair(soup, warnings, Progress());
    RC_ASSERT(is_closed_manifold(to_soup(mesh)));
    RC_ASSERT(std::abs(volume_mm3(mesh) - volume) < 0.02 * volume);
    RC_ASSERT(warnings.empty() == (losses == 0));
  }));
}

TEST(Repair, RealModels) {
  for (const char* file : {"spot.obj", "rocker-arm.obj", "cow.obj"}) {
    PACKMERGER_TEST_MODEL(soup, file);
    EXPECT_EQ(repaired(soup).text, "") << file;
  }
  PACKMERGER_TEST_MODEL(bunny, "stanford-bunny.obj");
  const Repaired result = repaired(bunny);
  EXPECT_THAT(result.text, HasSubstr("5 holes filled"));
  EXPECT_THAT(result.text, HasSubstr("223 open edges"));
}

TEST(SurfaceQuery, KnowsDistanceInsideAndDepth) {
  const SurfaceQuery query(fixtures::nested_cubes(20, 8));
  EXPECT_NEAR(query.distance_mm({10, 10, 3}), 3, 1e-12);
  EXPECT_NEAR(query.distance_mm({10, 10, -5}), 5, 1e-12);
  EXPECT_EQ(query.winding_number({10, 10, 3}), 1);
  EXPECT_EQ(query.winding_number({10, 10, 10}), 0);
  EXPECT_EQ(query.winding_number({10, 10, 30}), 0);
  EXPECT_NEAR(query.ray_mm({9, 11, 0}, Vec3::UnitZ()).value(), 6, 1e-12);
  EXPECT_FALSE(query.ray_mm({10, 10, 30}, Vec3::UnitZ()).has_value());
}

}  // namespace
}  // namespace packmerger
