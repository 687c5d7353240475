// The solid rows of Table 1 that a slicer has to tell.
#include <gtest/gtest.h>

#include "base/error.h"
#include "bench/models.h"
#include "fixtures/profiles.h"
#include "printers/slice/slice.h"

namespace packmerger::bench {
namespace {

TEST(SolidRowsOfTableOne, Table) {
  const Profile profile = fixtures::shipped_profile("replicator");
  Pose middle = Pose::Identity();
  middle.translation() = (profile.build() - bounding_box(table_model()).sizes()) / 2;
  middle.translation().z() = 0;
  Tray tray;
  tray.parts.push_back(transformed(table_model(), middle));
  const Estimate e = estimate_by_slicer(profile, {tray}, Assembly{}, Progress());
  EXPECT_NEAR(e.time_s, 9780, 978);
  EXPECT_NEAR(e.support_g, 17, 1.7);
}

}  // namespace
}  // namespace packmerger::bench
