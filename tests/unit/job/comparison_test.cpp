#include <gtest/gtest.h>

#include "job/comparison_table.h"
#include "job/prepare.h"
#include "tray/job_json.h"

namespace packmerger {
namespace {

Estimate costing(double cost, double time_s = 3600) {
  Estimate estimate;
  estimate.cost = cost;
  estimate.time_s = time_s;
  estimate.currency = "EUR";
  return estimate;
}

TEST(Recommendation, PacksWhenThatIsCheaper) {
  Comparison ways;
  ways.as_is = costing(12);
  ways.solid = costing(10);
  ways.hollow = costing(8);
  ways.packed = costing(6);
  EXPECT_EQ(cheapest(ways), Variant::kPacked);
  EXPECT_NE(recommendation(ways).find("2.00 EUR less"), std::string::npos)
      << "against the best way";
}

TEST(Recommendation, SaysWhenLittleIsToBeGained) {
  Comparison ways;
  ways.solid = costing(10);
  ways.packed = costing(9.9);
  EXPECT_EQ(recommendation(ways).find("Little is to be gained"), 0u) << recommendation(ways);
  ways.packed = costing(9);
  EXPECT_EQ(recommendation(ways).find("Pack it"), 0u) << recommendation(ways);
}

TEST(Recommendation, TellsTheTruthWhenPackingDoesNotPay) {
  Comparison ways;
  ways.solid = costing(10);
  ways.hollow = costing(5);
  ways.packed = costing(6);
  EXPECT_EQ(cheapest(ways), Variant::kHollow);
  EXPECT_NE(recommendation(ways).find("does not pay"), std::string::npos);
  EXPECT_NE(recommendation(ways).find("--variant hollow"), std::string::npos);
}

TEST(Recommendation, PacksWhatFitsNoOtherWay) {
  Comparison ways;
  ways.packed = costing(100);
  EXPECT_EQ(cheapest(ways), Variant::kPacked);
  EXPECT_NE(recommendation(ways).find("does not fit"), std::string::npos);
  EXPECT_EQ(cheapest(Comparison{}), std::nullopt);
}

TEST(Recommendation, EqualCostMeansNoGluing) {
  Comparison ways;
  ways.solid = costing(5);
  ways.packed = costing(5);
  EXPECT_EQ(cheapest(ways), Variant::kSolid);
}

TEST(Table, ShowsEveryWayAndWhatDoesNotFit) {
  Comparison ways;
  ways.solid = costing(10, 7260);
  ways.packed = costing(6, 3630);
  const std::string table = comparison_table(ways, "Objet30");
  EXPECT_NE(table.find("2 h 01 min"), std::string::npos) << table;
  EXPECT_NE(table.find("-50 %"), std::string::npos) << table;
  EXPECT_NE(table.find("hollow, one piece    does not fit"), std::string::npos) << table;
}

TEST(Table, IsTheSameFromJson) {
  Comparison ways;
  ways.solid = costing(10, 7260);
  ways.packed = costing(6, 3630);
  ways.packed->source = EstimateSource::kSlicer;
  const Comparison again = comparison_of(comparison_json(ways));
  EXPECT_EQ(comparison_table(again, "x"), comparison_table(ways, "x"));
}

TEST(SpokenTime, RoundsOnce) {
  EXPECT_EQ(spoken_time(0), "0 s");
  EXPECT_EQ(spoken_time(59.4), "59 s");
  EXPECT_EQ(spoken_time(59.6), "1 min");
  EXPECT_EQ(spoken_time(3599), "1 h 00 min");
}

}  // namespace
}  // namespace packmerger
