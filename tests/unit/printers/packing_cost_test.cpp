#include "printers/estimate/packing_cost.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "base/error.h"
#include "fixtures/profiles.h"
#include "printers/estimate/estimate.h"
#include "printers/estimate/linear_estimate.h"
#include "printers/estimate/print_terms.h"
#include "shapes.h"

namespace packmerger {
namespace {

TrayMeasure measure(const Vec3& size_mm, double support_mm3, double material_mm3, int parts) {
  return {size_mm, support_mm3, material_mm3, parts};
}

Profile with(Profile profile, Objective objective) {
  profile.pack.objective = objective;
  profile.cost = {.currency = "EUR",
                  .model_price_per_g = 0.1,
                  .support_price_per_g = 0.2,
                  .machine_price_per_h = 6,
                  .labour_price_per_h = 30,
                  .glue_min_per_joint = 2,
                  .clean_min_per_tray = 10};
  return profile;
}

TEST(PackingCost, Paper) {
  Profile profile = with(fixtures::plain_polyjet(), Objective::kPaper);
  profile.pack.weight = 0.75;
  const Cost cost = packing_cost(profile);
  EXPECT_DOUBLE_EQ(cost.evaluate(measure(Vec3(10, 20, 30), 400, 999, 7)), 0.75 * 6000 + 0.25 * 400);
}

TEST(PackingCost, Height) {
  const Cost cost = packing_cost(with(fixtures::plain_polyjet(), Objective::kHeight));
  EXPECT_DOUBLE_EQ(cost.evaluate(measure(Vec3(10, 20, 30), 400, 999, 7)), 30);
}

TEST(PackingCost, PolyjetMoneyByHand) {
  const Cost cost = packing_cost(with(fixtures::plain_polyjet(), Objective::kPrinter));
  // 20 layers of 1 + 2 · (2 + 1) s; 1.8 g of model, 0.8 g of support; 2 joints and the tray
  const double hours = (60 + 20 * 7.0) / 3600;
  EXPECT_NEAR(cost.evaluate(measure(Vec3(10, 20, 10), 400, 1000, 3)),
              hours * 6 + 1.8 * 0.1 + 0.8 * 0.2 + (2 * 2 + 10) / 60.0 * 30, 1e-9);
}

// What an estimate counts and the search does not know would be packed for nothing.
TEST(PackingCost, TheSearchKnowsEveryFigureOfAnEstimate) {
  Tray tray;
  tray.parts = {printed::box(Vec3(0, 0, 5), Vec3(20, 30, 15))};
  for (const Profile& profile :
       {fixtures::plain_polyjet(), fixtures::plain_deposition(), fixtures::plain_toolpath()}) {
    const PrintTerms exact = both_terms(profile, {tray}, Progress()).straight;
    const PrintTerms known = predicted_terms(profile, measure(Vec3(20, 30, 15), 3000, 6000, 1));
    const LinearEstimate& sums = linear_estimate(exact.by);
    for (const auto& terms : {sums.time_s, sums.model_mm3, sums.support_g})
      for (const LinearTerm& term : terms) {
        if (term.amount(profile, exact) <= 0) continue;
        EXPECT_GT(term.amount(profile, known), 0) << term.key;
      }
  }
}

TEST(PackingCost, DepositionAgreesWithTheEstimate) {
  const Profile profile = with(fixtures::plain_deposition(), Objective::kPrinter);
  const Mesh part = printed::box(Vec3(0, 0, 8), Vec3(10, 10, 18));
  const Estimate e = estimate(profile, {printed::tray_of({part})}, {1, 0}, Progress());
  EXPECT_NEAR(packing_cost(profile).evaluate(measure(Vec3(10, 10, 18), 800, 1000, 1)), e.cost,
              1e-6);
}

TEST(PackingCost, RefusesAProfileItWouldDivideByZeroWith) {
  Profile profile = with(fixtures::plain_deposition(), Objective::kPrinter);
  profile.fdm.deposition_cm3_h = 0;
  EXPECT_THROW(packing_cost(profile), Error);
  profile = with(fixtures::plain_polyjet(), Objective::kPrinter);
  profile.polyjet.swath_mm = 0;
  EXPECT_THROW(packing_cost(profile), Error);
}

TEST(PackingCost, LowerBoundHoldsForEveryTrayThatHoldsMore) {
  EXPECT_TRUE(rc::check([] {
    const auto number = [](int high) { return *rc::gen::inRange(0, high) * 0.31; };
    const auto profiles = {fixtures::plain_polyjet(), fixtures::plain_deposition(),
                           fixtures::plain_toolpath()};
    const TrayMeasure few = measure(Vec3(number(900), number(600), number(400)), number(100000),
                                    number(1000000), *rc::gen::inRange(1, 20));
    const TrayMeasure more = measure(
        few.size_mm + Vec3(number(99), number(99), number(99)), few.support_mm3 + number(10000),
        few.material_mm3 + number(10000), few.parts + *rc::gen::inRange(0, 4));
    for (const Profile& profile : profiles)
      for (const Objective objective :
           {Objective::kPaper, Objective::kPrinter, Objective::kHeight}) {
        const Cost cost = packing_cost(with(profile, objective));
        RC_ASSERT(cost.lower_bound(few) <= cost.evaluate(few));
        RC_ASSERT(cost.lower_bound(few) <= cost.evaluate(more));
        RC_ASSERT(cost.lower_bound(few) <= cost.lower_bound(more));
      }
  }));
}

}  // namespace
}  // namespace packmerger
