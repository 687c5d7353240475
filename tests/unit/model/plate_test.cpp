// Polygons, and plates with walls.
#include "model/plate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/random.h"
#include "tests/fixtures/models.h"

namespace packmerger {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

Polygon circle(double x, double y, double radius, int corners) {
  Polygon polygon;
  for (int i = 0; i < corners; ++i) {
    const double angle = 2 * std::numbers::pi * i / corners;
    polygon.emplace_back(x + radius * std::cos(angle), y + radius * std::sin(angle));
  }
  return polygon;
}

// A simple polygon with pockets: corners at random distances from a middle.
Polygon star(Random& random, const Vec2& middle, double reach, int corners) {
  Polygon polygon;
  for (int i = 0; i < corners; ++i) {
    const double angle = 2 * std::numbers::pi * (i + 0.8 * random.unit()) / corners;
    const double radius = reach * (0.3 + 0.7 * random.unit());
    polygon.emplace_back(middle + radius * Vec2(std::cos(angle), std::sin(angle)));
  }
  return polygon;
}

Pose at(double x, double y) {
  Pose pose = Pose::Identity();
  pose.translation() = Vec3(x, y, 3);
  return pose;
}

TEST(Polygons, AreRefusedWithTheCornerThatIsWrong) {
  EXPECT_THAT(fault_of(circle(5, 5, 4, 60)), IsEmpty());
  EXPECT_THAT(fault_of({{0, 0}, {0, 9}, {9, 0}}), IsEmpty());  // clockwise
  EXPECT_THAT(fault_of({{0, 0}, {1, 0}}), HasSubstr("2 corners"));
  EXPECT_THAT(fault_of(circle(0, 0, 9, 501)), HasSubstr("at most 500"));
  EXPECT_THAT(fault_of({{0, 0}, {9, 9}, {9, 0}, {0, 9}}), HasSubstr("corner 1 and corner 3 meet"));
  EXPECT_THAT(fault_of({{0, 0}, {9, 0}, {9, 9}, {0, 0}}), HasSubstr("1 and 4 are the same point"));
  EXPECT_THAT(fault_of({{0, 0}, {9, 0}, {5, 0}, {5, 5}}), HasSubstr("turns back"));
  EXPECT_THAT(fault_of({{0, 0}, {9, 0}, {9, 9}, {4, 0}, {0, 9}}), HasSubstr("meet"));  // touches
  EXPECT_THAT(fault_of({{0, 0}, {4, 0}, {9, 0}}), HasSubstr("no area"));
}

TEST(Plates, WithoutAnOutlineOrKeptOutAreasHaveNoWalls) {
  const Plate plate;
  EXPECT_TRUE(plate.is_whole());
  EXPECT_EQ(plate.breach_mm(fixtures::cube(10), at(-100, 5)), 0);
  EXPECT_TRUE(std::isinf(plate.nearest_wall(Vec2(3, 3)).clearance_mm));
}

TEST(Plates, TellHowFarAPartStandsOverTheirOutline) {
  const Plate round(circle(50, 50, 50, 360), {});
  const TriangleSoup cube = fixtures::cube(10);  // its corner at the origin
  const auto breach = [&](double x, double y) { return round.breach_mm(cube, at(x - 5, y - 5)); };
  EXPECT_EQ(breach(50, 50), 0);
  EXPECT_LT(breach(94.9, 50), std::hypot(49.9, 5) - 50 + 0.01);
  EXPECT_NEAR(breach(7, 7), std::hypot(48, 48) - 50, 0.01);
}

TEST(Plates, KeepPartsOutOfAreasThatReachThroughThem) {
  // Neither has a corner within the other.
  const Plate post({}, {{{48, 0}, {52, 0}, {52, 100}, {48, 100}}});
  const TriangleSoup cube = fixtures::cube(10);
  EXPECT_GT(post.breach_mm(cube, at(45, 45)), 0.1);
  EXPECT_EQ(post.breach_mm(cube, at(52, 45)), 0);  // touches
  // A triangle of the part covers all of it.
  const Plate pin({}, {circle(50.7, 50.2, 0.1, 8)});
  EXPECT_GT(pin.breach_mm(cube, at(45, 45)), 0.05);
}

TEST(Plates, TakeTheOutlinesPocketsForKeptOutAreas) {
  const Polygon l{{0, 0}, {100, 0}, {100, 40}, {40, 40}, {40, 100}, {0, 100}};
  for (const Polygon& outline : {l, Polygon(l.rbegin(), l.rend())}) {
    const Plate plate(outline, {});
    ASSERT_EQ(plate.barred().size(), 1U);
    EXPECT_NEAR(plate.nearest_wall(Vec2(20, 20)).clearance_mm, 20, 1e-9);
    EXPECT_NEAR(plate.nearest_wall(Vec2(45, 47)).clearance_mm, -5, 1e-9);
    EXPECT_LT((plate.nearest_wall(Vec2(45, 47)).away - Vec2(-1, 0)).norm(), 1e-9);
  }
}

TEST(Plates, AgreeWithPointsOverAnyOutlineAndAnyAreas) {
  Random random(7);
  for (int round = 0; round < 60; ++round) {
    const Polygon outline = star(random, Vec2(50, 50), 50, 3 + static_cast<int>(random.below(9)));
    if (!fault_of(outline).empty()) continue;
    std::vector<Polygon> areas;
    for (int i = 0; i < 3; ++i)
      areas.push_back(star(random, Vec2(100 * random.unit(), 100 * random.unit()), 15, 5));
    const Plate plate(outline, areas);
    const auto allowed = [&](const Vec2& point) {
      return contains(outline, point) && std::none_of(areas.begin(), areas.end(), [&](auto& area) {
               return contains(area, point);
             });
    };
    for (int i = 0; i < 200; ++i) {
      const Vec2 point(100 * random.unit(), 100 * random.unit());
      const Plate::Wall wall = plate.nearest_wall(point);
      EXPECT_EQ(wall.clearance_mm > 0, allowed(point));
      // It grows in the direction told.
      EXPECT_GT(plate.nearest_wall(point + 1e-7 * wall.away).clearance_mm, wall.clearance_mm);
    }
    // A square that may stand there holds no point that may not, and the other way round.
    const TriangleSoup cube = fixtures::cube(8);
    for (int i = 0; i < 100; ++i) {
      const Vec2 corner(95 * random.unit(), 95 * random.unit());
      const double breach = plate.breach_mm(cube, at(corner.x(), corner.y()));
      double deepest = 0;
      for (int k = 0; k < 400; ++k) {
        const Vec2 point = corner + 8 * Vec2((k % 20 + 0.5) / 20, (k / 20 + 0.5) / 20);
        deepest = std::max(deepest, -plate.nearest_wall(point).clearance_mm);
      }
      EXPECT_TRUE(breach > kWallTolerance_mm || deepest <= 1e-5);
      EXPECT_TRUE(breach <= 0.5 || deepest > 0);
    }
  }
}

TEST(Hulls, HoldAllPointsAndTurnLeftEverywhere) {
  Random random(3);
  for (int round = 0; round < 50; ++round) {
    std::vector<Vec2> points;
    for (int i = 0; i < 40; ++i)
      points.emplace_back(static_cast<double>(random.below(12)),
                          static_cast<double>(random.below(12)));
    const Polygon hull = convex_hull(points);
    EXPECT_THAT(fault_of(hull), IsEmpty());
    EXPECT_GT(signed_area_mm2(hull), 0);
    for (std::size_t i = 0; i < hull.size(); ++i) {
      const Vec2 side = hull[(i + 1) % hull.size()] - hull[i];
      for (const Vec2& point : points) {
        const Vec2 to = point - hull[i];
        EXPECT_GE(side.x() * to.y() - side.y() * to.x(), 0);
      }
    }
  }
}

TEST(InnerPoints, LieInside) {
  Random random(5);
  for (int round = 0; round < 200; ++round) {
    const Polygon polygon = star(random, Vec2(3, 4), 10, 3 + static_cast<int>(random.below(20)));
    if (!fault_of(polygon).empty()) continue;
    const Vec2 inner = inner_point(polygon);
    EXPECT_TRUE(contains(polygon, inner));
    EXPECT_GT((nearest_on_border(polygon, inner) - inner).norm(), 0.01);
  }
}

// A slot half a millimetre wider than the box, off every lattice.
TEST(Plates, FindTheSpotBetweenTwoAreas) {
  const auto strip = [](double low, double high) {
    return Polygon{{low, 0}, {high, 0}, {high, 60}, {low, 60}};
  };
  const Plate plate({}, {strip(-5, 41.3), strip(51.8, 120)});
  const Mesh box = closed_mesh(fixtures::cube(10));
  const auto spot = plate.spot_for(box, Vec2(100, 60));
  ASSERT_TRUE(spot);
  EXPECT_LE(plate.breach_mm(box, at(spot->x(), spot->y())), kWallTolerance_mm);
  EXPECT_FALSE(Plate({}, {strip(-5, 41.3), strip(51.2, 120)}).spot_for(box, Vec2(100, 60)));
}

TEST(Polygons, CutStretchesIntoThePiecesWithin) {
  const Polygon u{{0, 0}, {30, 0}, {30, 20}, {20, 20}, {20, 5}, {10, 5}, {10, 20}, {0, 20}};
  const std::vector<Stretch> pieces = pieces_within(u, Vec2(-5, 10), Vec2(25, 10));
  ASSERT_EQ(pieces.size(), 2U);
  EXPECT_TRUE(pieces[0][0].isApprox(Vec2(0, 10)));
  EXPECT_TRUE(pieces[0][1].isApprox(Vec2(10, 10)));
  EXPECT_TRUE(pieces[1][0].isApprox(Vec2(20, 10)));
  EXPECT_TRUE(pieces[1][1].isApprox(Vec2(25, 10)));
}

}  // namespace
}  // namespace packmerger
