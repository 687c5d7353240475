#include "job/promises.h"

#include <gtest/gtest.h>

#include "fixtures/models.h"

namespace packmerger {
namespace {

const Room kRoom{Vec3::Zero(), Vec3(100, 100, 100)};

Arrangement tray_of(const std::vector<TriangleSoup>& bodies) {
  Arrangement arrangement;
  for (const TriangleSoup& body : bodies) {
    JobPart part;
    part.id = static_cast<int>(arrangement.parts.size()) + 1;
    part.surface = closed_mesh(body);
    arrangement.removal_order.push_back(part.id);
    arrangement.parts.push_back(std::move(part));
  }
  return arrangement;
}

std::string broken(const Arrangement& arrangement, double gap_mm) {
  const auto found = broken_promise(arrangement, gap_mm, kRoom, Progress());
  return found ? found->what : "";
}

TriangleSoup cube_at(const Vec3& corner) {
  return fixtures::box(corner, corner + Vec3::Constant(10));
}

// A cube of 10 mm under a roof that is 20 mm above the plate.
Arrangement cube_under_roof() {
  const TriangleSoup roof = fixtures::box(Vec3(0, 0, 20), Vec3(40, 40, 25));
  return tray_of({cube_at(Vec3(15, 15, 0)), roof});
}

TEST(Promises, HoldForPartsThatStandApart) {
  EXPECT_EQ(broken(tray_of({cube_at(Vec3(0, 0, 0)), cube_at(Vec3(11, 0, 0))}), 1), "");
  EXPECT_EQ(broken(tray_of({cube_at(Vec3(0, 0, 0)), cube_at(Vec3(10.001, 0, 0))}), 0), "");
}

TEST(Promises, ATouchOrACutIsSeenWithoutAGapToo) {
  const std::string cut = "Two parts touch or lie within one another";
  EXPECT_EQ(broken(tray_of({cube_at(Vec3(0, 0, 0)), cube_at(Vec3(9.9, 0, 0))}), 0), cut);
  EXPECT_EQ(broken(tray_of({cube_at(Vec3(0, 0, 0)), cube_at(Vec3(10, 0, 0))}), 0), cut);
  EXPECT_EQ(
      broken(tray_of({fixtures::box(Vec3(0, 0, 0), Vec3(30, 30, 30)), cube_at(Vec3(5, 5, 5))}), 0),
      cut);
}

TEST(Promises, TheGapIsMeasuredOnWhatIsWritten) {
  const auto found = broken_promise(tray_of({cube_at(Vec3(0, 0, 0)), cube_at(Vec3(10.9, 0, 0))}), 1,
                                    kRoom, Progress());
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->missing_mm, 0.1, 1e-5);
}

TEST(Promises, NothingStandsOutOfTheRoom) {
  EXPECT_NE(broken(tray_of({cube_at(Vec3(90.1, 0, 0))}), 1).find("out of the build volume"),
            std::string::npos);
  EXPECT_NE(broken(tray_of({cube_at(Vec3(0, 0, -0.01))}), 1).find("out of the build volume"),
            std::string::npos);
}

TEST(Promises, WhatIsUnderAnotherPartDoesNotComeOutBeforeIt) {
  Arrangement tray = cube_under_roof();
  EXPECT_EQ(broken(tray, 1), "Part 1 cannot be taken out past part 2");
  std::swap(tray.removal_order[0], tray.removal_order[1]);
  EXPECT_EQ(broken(tray, 1), "");
  tray.removal_order.pop_back();
  EXPECT_NE(broken(tray, 1), "") << "one is not listed";
}

TEST(Promises, APathIsFollowed) {
  Arrangement tray = cube_under_roof();
  tray.removal_paths[1] = {Vec3(0, 0, 4), Vec3(30, 0, 0)};
  EXPECT_EQ(broken(tray, 1), "");
  tray.removal_paths[1] = {Vec3(20, 0, 0)};
  EXPECT_NE(broken(tray, 1), "") << "it ends under the roof";
  tray.removal_paths[1] = {Vec3(0, 0, 12), Vec3(30, 0, 0)};
  EXPECT_NE(broken(tray, 1), "") << "it leads through the roof";
}

}  // namespace
}  // namespace packmerger
