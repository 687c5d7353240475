#include "job/compare/unpacked.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <set>

#include "fixtures/models.h"
#include "job/promises.h"
#include "model/printer.h"
#include "shape/read/soup.h"

namespace packmerger {
namespace {

struct Rectangle {
  int tray;
  Vec2 low, high;
};

std::vector<Rectangle> placed(const std::vector<Vec2>& sizes, const Vec2& tray, double gap) {
  const std::vector<Slot> slots = side_by_side(sizes, tray, gap);
  std::vector<Rectangle> rectangles;
  for (std::size_t i = 0; i < sizes.size(); ++i)
    rectangles.push_back({slots[i].tray, slots[i].corner, slots[i].corner + sizes[i]});
  return rectangles;
}

TEST(SideBySide, NothingOverlapsOrLeavesTheTray) {
  EXPECT_TRUE(rc::check([] {
    const Vec2 tray(100, 80);
    const double gap = 1;
    std::vector<Vec2> sizes;
    for (int i = *rc::gen::inRange(1, 40); i > 0; --i)
      sizes.emplace_back(*rc::gen::inRange(1, 101), *rc::gen::inRange(1, 81));
    const std::vector<Rectangle> all = placed(sizes, tray, gap);
    for (std::size_t i = 0; i < all.size(); ++i) {
      RC_ASSERT((all[i].low.array() >= -1e-9).all());
      RC_ASSERT((all[i].high.array() <= tray.array() + 1e-9).all());
      for (std::size_t j = 0; j < i; ++j) {
        if (all[i].tray != all[j].tray) continue;
        const bool apart = (all[i].low.array() >= all[j].high.array() + gap - 1e-9).any() ||
                           (all[j].low.array() >= all[i].high.array() + gap - 1e-9).any();
        RC_ASSERT(apart);
      }
    }
  }));
}

TEST(SideBySide, AsManyAsFitShareATray) {
  const std::vector<Vec2> four(4, Vec2(40, 40));
  std::set<int> trays;
  for (const Slot& slot : side_by_side(four, Vec2(81, 81), 1)) trays.insert(slot.tray);
  EXPECT_EQ(trays.size(), 1u);
  trays.clear();
  for (const Slot& slot : side_by_side(four, Vec2(80.5, 81), 1)) trays.insert(slot.tray);
  EXPECT_EQ(trays.size(), 2u);
}

// Nothing of it: in powder the walls, the floor and the ceiling are as far away as other parts.
TEST(InPowder, ModelsKeepTheGapToAllWalls) {
  Profile profile = read_profile("objet30");
  profile.technology = Technology::kPowder;
  profile.build_mm = {50, 40, 30};
  profile.pack.gap_mm = 2;
  const WholeModels three(3, std::make_shared<const Mesh>(closed_mesh(fixtures::cube(20))));
  const auto arrangement = stand_as_is(three, profile);
  ASSERT_TRUE(arrangement);
  EXPECT_EQ(arrangement->trays, 2);
  for (const Tray& tray : trays_of(*arrangement))
    for (const Mesh& part : tray.parts) {
      const Box3 box = bounding_box(part);
      EXPECT_GE(box.min().minCoeff(), 2 - 1e-9);
      EXPECT_GE((profile.build() - box.max()).minCoeff(), 2 - 1e-9);
    }
  EXPECT_FALSE(
      stand_as_is({std::make_shared<const Mesh>(closed_mesh(fixtures::cube(27)))}, profile));
}

TEST(InPowder, ModelsStandInLayers) {
  Profile profile = read_profile("objet30");
  profile.technology = Technology::kPowder;
  profile.build_mm = {50, 30, 46};
  profile.pack.gap_mm = 2;
  const WholeModels five(5, std::make_shared<const Mesh>(closed_mesh(fixtures::cube(20))));
  const auto arrangement = stand_as_is(five, profile);
  ASSERT_TRUE(arrangement);
  EXPECT_EQ(arrangement->trays, 2);
  EXPECT_FALSE(broken_promise(*arrangement, 2, whole_room(profile), Progress()));
  EXPECT_EQ(arrangement->parts[3].tray, 1);
  EXPECT_NEAR(arrangement->parts[3].pose.translation().z(), 24, 1e-9);
  EXPECT_EQ(arrangement->removal_order.back(), 2);
}

TEST(SideBySide, OneAloneStandsInTheMiddle) {
  const Slot slot = side_by_side({Vec2(20, 10)}, Vec2(100, 50), 1).front();
  EXPECT_EQ(slot.corner, Vec2(40, 20));
}

// A box from the origin.
std::shared_ptr<const Mesh> box(double x, double y, double z) {
  TriangleSoup soup;
  for (int i = 0; i < 8; ++i) soup.points.emplace_back(i & 1 ? x : 0, i & 2 ? y : 0, i & 4 ? z : 0);
  soup.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return std::make_shared<const Mesh>(closed_mesh(soup));
}

Box3 extent(const Arrangement& arrangement) {
  Box3 all;
  for (const Tray& tray : trays_of(arrangement))
    for (const Mesh& part : tray.parts) all.extend(bounding_box(part));
  return all;
}

TEST(StandBest, LaysATallBoxDown) {
  Profile profile = read_profile("objet30");
  const auto tall = box(20, 30, 120);
  const auto best = stand_best({tall}, profile, Progress());
  ASSERT_TRUE(best);
  EXPECT_NEAR(extent(*best).sizes().z(), 20, 1e-9) << "PolyJet time follows layers";
  const auto as_is = stand_as_is({tall}, profile);
  ASSERT_TRUE(as_is);
  EXPECT_NEAR(extent(*as_is).sizes().z(), 120, 1e-9);
}

// A steep pyramid needs no support on its point, and slicers refuse what stands so.
TEST(StandBest, NeverStandsOnAPointWhatIsSliced) {
  const Profile profile = read_profile("marlin");
  TriangleSoup soup;
  soup.points = {{0, 0, 0}, {40, 0, 0}, {40, 40, 0}, {0, 40, 0}, {20, 20, 30}};
  soup.triangles = {{3, 2, 1}, {3, 1, 0}, {0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}};
  for (const double tip_mm : {30.0, -30.0}) {
    soup.points[4].z() = tip_mm;
    if (tip_mm < 0)
      for (auto& corners : soup.triangles) std::swap(corners[0], corners[1]);
    const auto best =
        stand_best({std::make_shared<const Mesh>(closed_mesh(soup))}, profile, Progress());
    ASSERT_TRUE(best);
    const Mesh standing = trays_of(*best).front().parts.front();
    EXPECT_GE(std::count_if(standing.points().begin(), standing.points().end(),
                            [](const Vec3& point) { return point.z() < 1e-6; }),
              3)
        << "a face is on the plate";
  }
}

// Of a long edge the first layer has matter enough, but none as wide as a line.
TEST(StandBest, NeverStandsOnAnEdgeWhatIsSliced) {
  TriangleSoup soup;
  for (const double y : {0.0, 60.0})
    for (const Vec2& at : {Vec2(0, 0), Vec2(8, 30), Vec2(-8, 30)})
      soup.points.emplace_back(at.x(), y, at.y());
  soup.triangles = {{0, 1, 2}, {3, 5, 4}, {0, 3, 4}, {0, 4, 1},
                    {1, 4, 5}, {1, 5, 2}, {2, 5, 3}, {2, 3, 0}};
  const auto best = stand_best({std::make_shared<const Mesh>(closed_mesh(soup))},
                               read_profile("marlin"), Progress());
  ASSERT_TRUE(best);
  const Mesh standing = trays_of(*best).front().parts.front();
  EXPECT_GE(std::count_if(standing.points().begin(), standing.points().end(),
                          [](const Vec3& point) { return point.z() < 1e-6; }),
            3);
}

// A plate with pins on both sides. Each is as wide as two lines, though not its mean distance from
// its border.
TEST(StandBest, StandsOnPinsWhatIsSliced) {
  TriangleSoup brush = fixtures::box(Vec3(0, 0, 0.6), Vec3(24, 24, 1.6));
  for (double x = 0.5; x < 24; x += 2)
    for (double y = 0.5; y < 24; y += 2)
      append(brush, fixtures::box(Vec3(x, y, 0), Vec3(x + 0.8, y + 0.8, 2.2)));
  const auto best = stand_best({std::make_shared<const Mesh>(closed_mesh(brush))},
                               read_profile("marlin"), Progress());
  ASSERT_TRUE(best);
  EXPECT_NEAR(extent(*best).sizes().z(), 2.2, 1e-9);
}

// A tube whose wall is thinner than a line has a wide outline only.
TEST(StandBest, NeverStandsOnATubeThinnerThanALine) {
  const auto ring = [](double z) {
    TriangleSoup at;
    for (const double inset : {0.0, 0.2})
      for (const Vec2& corner : {Vec2(0, 0), Vec2(1, 0), Vec2(1, 1), Vec2(0, 1)})
        at.points.emplace_back(inset + corner.x() * (60 - 2 * inset),
                               inset + corner.y() * (60 - 2 * inset), z);
    return at;
  };
  TriangleSoup tube = ring(0);  // outside 0 to 3, inside 4 to 7
  append(tube, ring(1.2));
  const auto quad = [&](int a, int b, int c, int d) {
    tube.triangles.push_back({a, b, c});
    tube.triangles.push_back({a, c, d});
  };
  for (int i = 0; i < 4; ++i) {
    const int j = (i + 1) % 4;
    quad(i, j, j + 8, i + 8);
    quad(j + 4, i + 4, i + 12, j + 12);
    quad(j, i, i + 4, j + 4);
    quad(i + 8, j + 8, j + 12, i + 12);
  }
  const auto best = stand_best({std::make_shared<const Mesh>(closed_mesh(tube))},
                               read_profile("marlin"), Progress());
  ASSERT_TRUE(best);
  EXPECT_GT(
      std::abs(best->parts[0].pose.linear()(2, 0)) + std::abs(best->parts[0].pose.linear()(2, 1)),
      0.5)
      << "it lies";
}

TEST(StandBest, TurnsToFitAndSaysWhenItCannot) {
  Profile profile = read_profile("objet30");
  profile.build_mm = {200, 50, 60};
  const auto best = stand_best({box(40, 190, 55)}, profile, Progress());
  ASSERT_TRUE(best);
  EXPECT_TRUE((extent(*best).max().array() <= profile.build().array() + 1e-9).all());
  EXPECT_TRUE((extent(*best).min().array() >= -1e-9).all());
  EXPECT_FALSE(stand_as_is({box(40, 190, 55)}, profile));
  EXPECT_FALSE(stand_best({box(61, 190, 61)}, profile, Progress()));
}

TEST(StandBest, TurningKeepsShapeAndVolume) {
  const Profile profile = read_profile("objet30");
  const auto model = box(10, 20, 30);
  const auto best = stand_best({model, model}, profile, Progress());
  ASSERT_TRUE(best);
  ASSERT_EQ(best->parts.size(), 2u);
  for (const JobPart& part : best->parts) {
    EXPECT_NEAR(part.pose.linear().determinant(), 1, 1e-12);
    EXPECT_NEAR(volume_mm3(transformed(part.surface, part.pose)), 6000, 1e-6);
  }
}

}  // namespace
}  // namespace packmerger
