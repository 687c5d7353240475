// Ways that cannot be made are columns of the comparison, not its end.
#include "job/plan.h"

#include <gmock/gmock.h>

#include "base/files.h"
#include "fixtures/models.h"
#include "job/prepare.h"
#include "model/stl.h"

namespace packmerger {
namespace {

using testing::HasSubstr;

class RefusedWays : public testing::Test {
 protected:
  PlanOptions options_of(const TriangleSoup& soup) {
    PlanOptions options;
    options.models = {folder_.path() / "model.stl"};
    const Mesh mesh = closed_mesh(soup);
    write_file_whole(options.models[0], binary_stl({&mesh}));
    return options;
  }

  // What preparing that way is refused with.
  std::string refusal(const Profile& profile, const PlanOptions& options, Variant variant) {
    try {
      prepare(profile, options, variant, folder_.path() / "out", Progress());
    } catch (const Error& error) {
      EXPECT_EQ(error.fault(), Fault::kBadInput);
      return std::string(error.what()) + ". " + error.hint();
    }
    return "";
  }

  TemporaryFolder folder_;
};

TEST_F(RefusedWays, APyramidOnItsTipIsStillComparedOtherWaysUp) {
  TriangleSoup soup;
  soup.points = {{0, 0, 12}, {12, 0, 12}, {12, 12, 12}, {0, 12, 12}, {6, 6, 0}};
  soup.triangles = {{1, 2, 3}, {0, 1, 3}, {4, 1, 0}, {4, 2, 1}, {4, 3, 2}, {4, 0, 3}};
  PlanOptions options = options_of(soup);
  options.split = options.hollow = false;
  const Comparison ways = plan(read_profile("marlin"), options, Progress()).job.estimates;
  EXPECT_FALSE(ways.as_is);
  ASSERT_TRUE(ways.refused.contains("as_is"));
  EXPECT_THAT(ways.refused.at("as_is").hint, HasSubstr("stands on a face"));
  EXPECT_EQ(ways.refused.size(), 1u);
  EXPECT_TRUE(ways.solid && ways.hollow && ways.packed);
}

// Of a cube that was hollowed by its maker, and of one that is hollowed here.
TEST_F(RefusedWays, WhereNoPowderComesOutIsRefused) {
  Profile profile = read_profile("fuse1");
  profile.pack.placement = Placement::kDrop;
  PlanOptions options = options_of(fixtures::nested_cubes(30, 20));
  options.split = options.hollow = false;
  EXPECT_THAT(refusal(profile, options, Variant::kSolid), HasSubstr("no two openings of 5 mm"));

  options = options_of(fixtures::cube(30));
  options.split = false;
  Comparison ways = plan(profile, options, Progress()).job.estimates;
  EXPECT_TRUE(ways.as_is && ways.solid);
  EXPECT_TRUE(ways.refused.contains("hollow"));
  EXPECT_THAT(ways.refused.at("hollow").hint, HasSubstr("two openings of 5 mm"));

  options.hollow = false;
  ways = plan(profile, options, Progress()).job.estimates;
  EXPECT_TRUE(ways.refused.empty());
  EXPECT_TRUE(ways.as_is && ways.solid && ways.packed);
}

TEST_F(RefusedWays, WhatCannotBeHollowedIsComparedSolid) {
  const PlanOptions options = options_of(fixtures::cube(60));
  Profile profile = read_profile("objet30");
  profile.shape.voxel_mm = 0.02;
  const Comparison ways = plan(profile, options, Progress()).job.estimates;
  EXPECT_TRUE(ways.as_is && ways.solid);
  EXPECT_FALSE(ways.hollow || ways.packed);
  for (const char* way : {"hollow", "packed"}) {
    ASSERT_TRUE(ways.refused.contains(way)) << way;
    EXPECT_THAT(ways.refused.at(way).what, HasSubstr("too large for its distance grid"));
  }
  for (const Variant variant : {Variant::kHollow, Variant::kPacked})
    EXPECT_THAT(refusal(profile, options, variant),
                testing::AllOf(HasSubstr("too large for its distance grid. Raise voxel_mm"),
                               HasSubstr("Or use --variant solid.")));
  EXPECT_EQ(refusal(profile, options, Variant::kCheapest), "");
}

TEST_F(RefusedWays, WhereNoWayCanBeMadeItIsSaidAtOnce) {
  TriangleSoup soup;  // as no way up of a needle of 0.1 mm can be sliced
  soup.points = {{0, 0, 0}, {0.1, 0, 0}, {0, 0.1, 0}, {0, 0, 0.1}};
  soup.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  PlanOptions options = options_of(soup);
  options.split = options.hollow = false;
  try {
    plan(read_profile("marlin"), options, Progress());
    ADD_FAILURE() << "nothing was refused";
  } catch (const Error& error) {
    EXPECT_EQ(error.fault(), Fault::kBadInput);
    EXPECT_FALSE(error.hint().empty());
  }
}

}  // namespace
}  // namespace packmerger
