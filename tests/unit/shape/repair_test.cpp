#include "shape/surface/repair.h"

#include <algorithm>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "fixtures/fault_of.h"
#include "fixtures/models.h"
#include "shape/read/soup.h"
#include "shape/surface/surface_query.h"

namespace packmerger {
namespace {

using fixtures::together;
using testing::HasSubstr;

struct Repaired {
  Mesh mesh;
  std::string text;     // of the warning "repaired"; empty without one
  std::string changed;  // of the warning "shape_changed"
};

Repaired repaired(const TriangleSoup& soup) {
  Warnings warnings;
  Repaired result{repair(soup, warnings, Progress()), "", ""};
  for (const Warning& warning : warnings) {
    EXPECT_THAT(warning.code, testing::AnyOf("repaired", "shape_changed"));
    (warning.code == "repaired" ? result.text : result.changed) = warning.text;
  }
  EXPECT_TRUE(is_closed_manifold(result.mesh));
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
  return fixtures::refusal_of([&] {
    Warnings warnings;
    repair(soup, warnings, Progress());
  });
}

TEST(Repair, CleanInputPassesUnchanged) {
  for (const TriangleSoup& model :
       {fixtures::cube(10), fixtures::sphere(10, 3), fixtures::torus(20, 5, 24, 12),
        fixtures::nested_cubes(20, 8),
        together(fixtures::cube(5), moved(fixtures::cube(5), {9, 0, 0}))}) {
    const Repaired result = repaired(model);
    EXPECT_EQ(result.text, "");
    const TriangleView out(result.mesh);
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
  EXPECT_EQ(result.mesh.n_points(), fixtures::sphere(10, 2).points.size());
}

TEST(Repair, ClosesCracksOfSinglePrecision) {
  TriangleSoup soup = exploded(fixtures::sphere(10, 2));
  for (std::size_t i = 0; i < soup.points.size(); ++i)
    soup.points[i].x() += 1e-6 * (static_cast<double>(i % 7) - 3);
  const Repaired result = repaired(soup);
  EXPECT_THAT(result.text, HasSubstr(" mended"));
  EXPECT_EQ(result.mesh.n_triangles(), soup.triangles.size());
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

TEST(Repair, APieceWithinAnotherIsWhatItsTurningSays) {
  const TriangleSoup outer = fixtures::cube(20);
  const TriangleSoup inner = fixtures::box(Vec3::Constant(6), Vec3::Constant(14));
  const TriangleSoup core = fixtures::box(Vec3::Constant(8), Vec3::Constant(12));
  const auto check = [](const TriangleSoup& model, double volume, bool is_told) {
    for (const bool inside_out : {false, true}) {
      const Repaired result = repaired(inside_out ? fixtures::reversed(model) : model);
      EXPECT_NEAR(volume_mm3(result.mesh), volume, 1e-9) << inside_out;
      EXPECT_EQ(!result.changed.empty(), is_told) << result.changed;
    }
  };
  check(together(outer, inner), 8000, true);
  check(together(inner, outer), 8000, true);
  check(together(outer, fixtures::reversed(inner)), 8000 - 512, false);
  check(together(together(outer, fixtures::reversed(inner)), core), 8000 - 512 + 64, false);
  check(together(together(outer, inner), core), 8000, true);
}

TEST(Repair, TurnsAPieceAsMostOfItsTrianglesAre) {
  // The first triangles tell least: those of the cavity's wall are turned the wrong way.
  TriangleSoup cavity = fixtures::reversed(fixtures::box(Vec3::Constant(6), Vec3::Constant(14)));
  for (const int i : {0, 1, 2}) std::swap(cavity.triangles[i][0], cavity.triangles[i][1]);
  const Repaired result = repaired(together(cavity, fixtures::cube(20)));
  EXPECT_NEAR(volume_mm3(result.mesh), 8000 - 512, 1e-9);
  EXPECT_THAT(result.text, HasSubstr("3 facets turned round"));
}

TEST(Repair, NeverTurnsMoreTrianglesThanThereAre) {
  TriangleSoup soup = fixtures::reversed(fixtures::cube(10));
  for (const int i : {0, 5}) std::swap(soup.triangles[i][0], soup.triangles[i][1]);
  EXPECT_THAT(repaired(soup).text, HasSubstr(" 10 facets turned round"));
}

// A cube of 10 mm whose edges on the top are divided at these places, on one side only.
TriangleSoup cube_with_divided_edge(const std::vector<double>& places) {
  TriangleSoup soup = fixtures::cube(10);
  const auto corner = [&](const Vec3& at) {
    return static_cast<int>(std::find(soup.points.begin(), soup.points.end(), at) -
                            soup.points.begin());
  };
  const int a = corner({0, 0, 10});
  const int b = corner({10, 0, 10});
  const auto holds = [&](const auto& t, int point) {
    return std::find(t.begin(), t.end(), point) != t.end();
  };
  const auto found = std::find_if(soup.triangles.begin(), soup.triangles.end(),
                                  [&](const auto& t) { return holds(t, a) && holds(t, b); });
  auto t = *found;
  soup.triangles.erase(found);
  while (t[2] == a || t[2] == b) std::rotate(t.begin(), t.begin() + 1, t.end());
  int last = t[0];
  for (const double place : places) {
    const Vec3 from = soup.points[t[0]];
    const Vec3 to = soup.points[t[1]];
    soup.points.push_back(from + place * (to - from));
    soup.triangles.push_back({last, static_cast<int>(soup.points.size()) - 1, t[2]});
    last = static_cast<int>(soup.points.size()) - 1;
  }
  soup.triangles.push_back({last, t[1], t[2]});
  return soup;
}

TEST(Repair, MendsPointsOnEdges) {
  for (const auto& places : {std::vector{0.5}, {0.25, 0.5}, {0.1, 0.2, 0.3, 0.7, 0.9}, {1.0 / 3}}) {
    const Repaired result = repaired(exploded(cube_with_divided_edge(places)));
    EXPECT_NEAR(volume_mm3(result.mesh), 1000, 1e-4);
    EXPECT_EQ(result.mesh.n_points(), 8 + places.size());
    EXPECT_THAT(result.text, HasSubstr(" mended"));
    EXPECT_EQ(result.text.find("filled"), std::string::npos) << result.text;
    EXPECT_EQ(result.changed, "");
  }
}

TEST(Repair, TellsThatASkinBecameABody) {
  TriangleSoup bell;
  for (const auto& t : fixtures::sphere(10, 3).triangles) bell.triangles.push_back(t);
  bell.points = fixtures::sphere(10, 3).points;
  std::erase_if(bell.triangles, [&](const auto& t) {
    return (bell.points[t[0]] + bell.points[t[1]] + bell.points[t[2]]).z() < 0;
  });
  EXPECT_THAT(repaired(bell).changed, HasSubstr("open over its whole width"));
  TriangleSoup ball = fixtures::sphere(10, 5);
  ball.triangles.pop_back();
  EXPECT_EQ(repaired(ball).changed, "");
}

// A cube of 100 mm with a square hole in the middle of its top.
TriangleSoup cube_with_hole(double width_mm) {
  TriangleSoup soup = fixtures::cube(100);
  std::erase_if(soup.triangles, [&](const auto& triangle) {
    return std::all_of(triangle.begin(), triangle.end(),
                       [&](int corner) { return soup.points[corner].z() == 100; });
  });
  const int base = static_cast<int>(soup.points.size());
  for (const double half_mm : {50.0, width_mm / 2})
    for (const auto& [x, y] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}})
      soup.points.push_back({50 + x * half_mm, 50 + y * half_mm, 100});
  for (int i = 0; i < 4; ++i) {
    const int next = (i + 1) % 4;
    soup.triangles.push_back({base + i, base + next, base + 4 + next});
    soup.triangles.push_back({base + i, base + 4 + next, base + 4 + i});
  }
  return soup;
}

TEST(Repair, TellsOfAHoleWhoseMiddleIsMoreThanAHundredthFromItsRim) {
  EXPECT_EQ(repaired(cube_with_hole(1.9)).changed, "");
  for (const double width_mm : {2.3, 3.0, 4.9})
    EXPECT_THAT(repaired(cube_with_hole(width_mm)).changed, HasSubstr("closed a hole wider"));
}

// A bottle that is drawn without thickness: its mouth is a hundredth of its area.
TEST(Repair, TellsOfAWideHoleAndOfWhatIsLeftOut) {
  TriangleSoup bottle = fixtures::sphere(10, 3);
  std::erase_if(bottle.triangles, [&](const auto& triangle) {
    return std::all_of(triangle.begin(), triangle.end(),
                       [&](int corner) { return bottle.points[corner].z() > 9.8; });
  });
  EXPECT_THAT(repaired(bottle).changed, HasSubstr("closed a hole wider than 2 %"));

  TriangleSoup shard = fixtures::sphere(10, 3);
  const int base = static_cast<int>(shard.points.size());
  shard.points.insert(shard.points.end(), {{20, 0, 0}, {20.1, 0, 0}, {20, 0.1, 0}});
  shard.triangles.push_back({base, base + 1, base + 2});
  EXPECT_THAT(repaired(shard).changed, HasSubstr("left out"));
  for (int i = 0; i < 3; ++i) shard.points[base + i].x() -= 9.95;
  EXPECT_EQ(repaired(shard).changed, "") << "beside the surface";
  for (int i = 0; i < 3; ++i) shard.points[base + i].x() -= 6;
  EXPECT_EQ(repaired(shard).changed, "") << "within the matter";
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
  EXPECT_EQ(result.mesh.n_triangles(), 320u);
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
    RC_ASSERT(is_closed_manifold(mesh));
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
