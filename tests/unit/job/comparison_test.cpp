#include <gtest/gtest.h>

#include "job/compare/advice.h"
#include "job/compare/comparison_table.h"
#include "tray/comparison_json.h"

namespace packmerger {
namespace {

Estimate costing(double cost, double time_s = 3600) {
  Estimate estimate;
  estimate.cost = cost;
  estimate.time_s = time_s;
  estimate.currency = "EUR";
  return estimate;
}

TEST(Advice, PacksWhenThatIsCheaper) {
  Comparison ways;
  ways.as_is = costing(12);
  ways.solid = costing(10);
  ways.hollow = costing(8);
  ways.packed = costing(6);
  EXPECT_EQ(cheapest(ways), Variant::kPacked);
  EXPECT_NE(advice(ways).text.find("2.00 EUR less"), std::string::npos) << "against the best way";
}

TEST(Advice, SaysWhenLittleIsToBeGained) {
  Comparison ways;
  ways.solid = costing(10);
  ways.packed = costing(9.9);
  EXPECT_EQ(advice(ways).text.find("Little is to be gained"), 0u) << advice(ways).text;
  ways.packed = costing(9);
  EXPECT_EQ(advice(ways).text.find("Pack it"), 0u) << advice(ways).text;
}

TEST(Advice, TellsTheTruthWhenPackingDoesNotPay) {
  Comparison ways;
  ways.solid = costing(10);
  ways.hollow = costing(5);
  ways.packed = costing(6);
  ways.packed->parts = 4;
  EXPECT_EQ(cheapest(ways), Variant::kHollow);
  EXPECT_NE(advice(ways).text.find("does not pay"), std::string::npos);
  EXPECT_NE(advice(ways).text.find("printing it hollow"), std::string::npos);
  EXPECT_NE(comparison_table(ways, "x").find("Use --variant hollow."), std::string::npos);
  EXPECT_NE(comparison_table(ways, "x", "solid", "this").find("Use this hollow."),
            std::string::npos);
  EXPECT_EQ(comparison_table(ways, "x", "hollow").find("Use "), std::string::npos)
      << "it is prepared so";
}

TEST(Advice, PacksWhatFitsNoOtherWay) {
  Comparison ways;
  ways.packed = costing(100);
  EXPECT_EQ(cheapest(ways), Variant::kPacked);
  EXPECT_NE(advice(ways).text.find("does not fit"), std::string::npos);
  EXPECT_EQ(cheapest(Comparison{}), std::nullopt);
}

TEST(Advice, EqualCostMeansNoGluing) {
  Comparison ways;
  ways.solid = costing(5);
  ways.packed = costing(5);
  EXPECT_EQ(cheapest(ways), Variant::kSolid);
}

TEST(Advice, NamesTheWayThatPreparesCheapest) {
  for (const double solid : {4, 5, 9})
    for (const double hollow : {4, 5, 9})
      for (const double packed : {4, 5, 9}) {
        Comparison ways;
        ways.solid = costing(solid);
        ways.hollow = costing(hollow);
        ways.packed = costing(packed);
        const Advice told = advice(ways);
        EXPECT_EQ(told.variant, cheapest(ways));
        const bool packs = told.variant == Variant::kPacked;
        EXPECT_EQ(told.text.starts_with("Pack it"), packs) << told.text;
        if (packs) continue;
        EXPECT_NE(told.text.find(variant_name(*told.variant)), std::string::npos) << told.text;
      }
}

TEST(Advice, SavesNoMaterialAtTheExpenseOfHoursWithoutAPrice) {
  Comparison ways;
  ways.hollow = costing(8, 3600);
  ways.packed = costing(7, 5400);
  ways.packed->parts = 4;
  EXPECT_EQ(cheapest(ways), Variant::kPacked) << "an earlier version's figures: no sums";
  for (auto* way : {&ways.hollow, &ways.packed}) (*way)->material_cost = (*way)->cost;
  EXPECT_EQ(cheapest(ways), Variant::kHollow);
  EXPECT_EQ(advice(ways).text,
            "Packing does not pay here: it saves 1.00 EUR, but takes 50 % longer than printing it "
            "hollow, in one piece.");
  ways.packed->time_s = 3600;
  EXPECT_EQ(cheapest(ways), Variant::kPacked) << "no longer";
  ways.packed->time_s = 5400;
  ways.hollow->machine_cost = 1;
  EXPECT_EQ(cheapest(ways), Variant::kPacked) << "its hours have a price";
  ways.hollow.reset();
  EXPECT_EQ(cheapest(ways), Variant::kPacked) << "nothing else fits";
}

TEST(Table, WaysThatReadTheSameShareALine) {
  Comparison ways;
  ways.as_is = ways.solid = costing(10);
  ways.hollow = costing(8);
  ways.packed = costing(8.001);
  const std::string table = comparison_table(ways, "x");
  EXPECT_NE(table.find("\nas the file stands = solid, best way up "), std::string::npos) << table;
  EXPECT_NE(table.find("\nhollow, one piece = packed "), std::string::npos) << table;
  EXPECT_EQ(table.find("\npacked "), std::string::npos) << table;
}

TEST(Table, CallsLostPowderByItsName) {
  Comparison ways;
  ways.solid = costing(10);
  ways.solid->support_g = 5;
  ways.solid->support_mm3 = 0;
  EXPECT_NE(comparison_table(ways, "x").find("lost powder"), std::string::npos);
  ways.solid->support_mm3 = 20;
  EXPECT_EQ(comparison_table(ways, "x").find("lost powder"), std::string::npos);
  EXPECT_NE(comparison_table(ways, "x").find("support"), std::string::npos);
}

TEST(Table, ShowsTheThreeSumsOfMoneyAndTheWorkByHand) {
  Comparison ways;
  ways.solid = costing(10.5);
  EXPECT_EQ(comparison_table(ways, "x").find("1.50 EUR"), std::string::npos)
      << "an earlier version compared: its sums are not known";
  ways.solid->material_cost = 1.5;
  ways.solid->machine_cost = 2;
  ways.solid->hands_cost = 7;
  ways.solid->assembly_min = 14;
  const std::string table = comparison_table(ways, "x");
  EXPECT_NE(table.find("14 min"), std::string::npos) << table;
  for (const char* sum : {" 10.50 EUR ", " 1.50 EUR ", " 2.00 EUR ", " 7.00 EUR"})
    EXPECT_NE(table.find(sum), std::string::npos) << table;
}

TEST(ComparisonJson, OfAnEarlierVersionHasNoSums) {
  Comparison ways;
  ways.packed = costing(6, 3630);
  nlohmann::json json = comparison_json(ways);
  for (const char* key : {"material_cost", "machine_cost", "hands_cost"}) json["packed"].erase(key);
  EXPECT_EQ(comparison_table(comparison_of(json), "x"), comparison_table(ways, "x"));
  json["packed"].erase("cost");
  EXPECT_THROW(comparison_of(json), nlohmann::json::exception);
}

TEST(Table, ShowsEveryWayAndWhatDoesNotFit) {
  Comparison ways;
  ways.solid = costing(10, 7260);
  ways.packed = costing(6, 3630);
  const std::string table = comparison_table(ways, "Objet30");
  EXPECT_NE(table.find("2 h 01 min"), std::string::npos) << table;
  EXPECT_NE(table.find("-50 %"), std::string::npos) << table;
  EXPECT_NE(table.find("hollow, one piece   does not fit"), std::string::npos) << table;
}

TEST(Table, SaysWhyAWayCannotBeMadeOnceForAll) {
  Comparison ways;
  ways.solid = costing(10);
  ways.refused["as_is"] = {"It stands on a point\n\x1b[2J", "Turn it."};
  ways.refused["hollow"] = ways.refused["packed"] = {"No wall is kept", "Raise wall_mm."};
  const std::string table = comparison_table(ways, "x");
  EXPECT_NE(table.find("packed              cannot be made, see below\n"), std::string::npos)
      << table;
  EXPECT_NE(table.find("\nas the file stands: It stands on a point??[2J. Turn it.\n"
                       "hollow, one piece; packed: No wall is kept. Raise wall_mm.\n"),
            std::string::npos)
      << table;
  EXPECT_EQ(comparison_table(comparison_of(comparison_json(ways)), "x"), table);
  EXPECT_EQ(advice(ways).variant, Variant::kSolid);
  EXPECT_EQ(why_not(ways, Variant::kPacked), "No wall is kept");
  ways.solid.reset();
  EXPECT_EQ(why_not(ways, Variant::kSolid), "it does not fit, solid");
  EXPECT_NE(advice(ways).text.find("can be made for this printer in no way"), std::string::npos);
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
