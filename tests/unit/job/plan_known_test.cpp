// One way of a comparison that was made before, and when its figures are not to be believed.
#include "job/plan_known.h"

#include <gtest/gtest.h>

#include "base/files.h"
#include "fixtures/models.h"
#include "job/comparison_key.h"
#include "model/stl.h"

namespace packmerger {
namespace {

TEST(KnownPlan, IsNoneOfAnythingElse) {
  PlanOptions options;
  KnownWays known;
  known.compared.sha256 = comparison_sha256(Profile{}, options, {});
  options.seed = 2;
  EXPECT_FALSE(plan_known(Profile{}, options, known, Variant::kSolid, Progress()));
}

TEST(KnownPlan, APackingThatAClockEndsIsMadeAgain) {
  PlanOptions options;
  options.budget_s = 1;
  KnownWays known;
  known.compared.sha256 = comparison_sha256(Profile{}, options, {});
  EXPECT_FALSE(plan_known(Profile{}, options, known, Variant::kPacked, Progress()));
}

// What was compared is changed, as if it had come out otherwise then than it does now.
TEST(KnownPlan, IsNoneWhereItComesOutOtherwiseThisTime) {
  const TemporaryFolder folder;
  PlanOptions options;
  options.models = {folder.path() / "cube.stl"};
  const Mesh cube = closed_mesh(fixtures::cube(20));
  write_file_whole(options.models[0], binary_stl({&cube}));
  options.split = false;
  Profile profile = read_profile("objet30");
  profile.shape.wall_mm = 2;
  const Job compared = plan(profile, options, Progress()).job;
  const KnownWays known{compared.compared, compared.estimates,      compared.tetrahedra,
                        compared.clusters, compared.after_premerge, {}};
  ASSERT_FALSE(known.compared.warnings.empty()) << "its cavity is sealed";
  const auto holds = [&](const KnownWays& ways, Variant variant) {
    return plan_known(profile, options, ways, variant, Progress()).has_value();
  };
  for (const Variant variant : {Variant::kSolid, Variant::kHollow, Variant::kPacked})
    EXPECT_TRUE(holds(known, variant)) << variant_name(variant);

  KnownWays untold = known;
  untold.compared.warnings.clear();
  EXPECT_TRUE(holds(untold, Variant::kSolid)) << "which has no cavity";
  EXPECT_FALSE(holds(untold, Variant::kHollow));
  KnownWays resampled = known;
  resampled.resample_tolerance_mm = profile.shape.resample_tolerance_mm;
  KnownWays others = known;
  ++others.estimates.packed->parts;
  ++others.estimates.hollow->trays;
  KnownWays unfit = known;
  unfit.estimates.packed.reset();
  unfit.estimates.hollow.reset();
  for (const Variant variant : {Variant::kHollow, Variant::kPacked}) {
    EXPECT_FALSE(holds(resampled, variant)) << variant_name(variant);
    EXPECT_FALSE(holds(others, variant)) << variant_name(variant);
    EXPECT_FALSE(holds(unfit, variant)) << variant_name(variant);
  }
}

}  // namespace
}  // namespace packmerger
