// Prints made from known constants with the estimator itself, and what is found of those constants.
#include "job/calibrate/calibrate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <cmath>
#include <random>

#include "base/error.h"
#include "fixtures/models.h"
#include "fixtures/profiles.h"
#include "printers/estimate/estimate.h"
#include "printers/estimate/linear_estimate.h"
#include "printers/estimate/packing_cost.h"

namespace packmerger {
namespace {

using ::testing::HasSubstr;

struct Block {
  Vec3 size_mm;
  double lift_mm = 0;  // above the plate: so much support is below
};

Tray tray_of(const Block& block) {
  const Vec3 low(1, 1, block.lift_mm);
  Tray tray;
  tray.parts = {closed_mesh(fixtures::box(low, low + block.size_mm))};
  return tray;
}

// What a machine with the constants of `truth` takes, and what `profile` measures of the same tray.
CalibrationPrint print_of(const Profile& truth, const Profile& profile, const Block& block) {
  const std::vector<Tray> trays = {tray_of(block)};
  const Estimate made = estimate(truth, trays, {}, Progress());
  CalibrationPrint print;
  print.name = "block";
  print.terms = print_terms(profile, trays, Progress());
  print.time_s = made.time_s;
  print.model_g = made.model_g;
  if (made.support_g > 0) print.support_g = made.support_g;
  return print;
}

const CalibratedConstant& constant(const Calibration& fit, const std::string& key) {
  for (const CalibratedConstant& one : fit.constants)
    if (one.key == key) return one;
  throw std::out_of_range(key);
}

const QuantityFit& quantity(const Calibration& fit, const std::string& name) {
  for (const QuantityFit& one : fit.quantities)
    if (one.quantity == name) return one;
  throw std::out_of_range(name);
}

// Measured blocks that the constants of a PolyJet and of an FDM machine can be told apart by.
std::vector<PrintTerms> varied_terms(const Profile& profile) {
  std::vector<PrintTerms> terms;
  for (const Block& block :
       {Block{Vec3(10, 9, 4), 1}, Block{Vec3(80, 9, 25), 0}, Block{Vec3(10, 75, 10), 1},
        Block{Vec3(80, 80, 6), 0.5}, Block{Vec3(12, 8, 80), 0}, Block{Vec3(90, 45, 2), 2}})
    terms.push_back(print_terms(profile, {tray_of(block)}, Progress()));
  return terms;
}

// PrintTerms.GiveWhatTheEstimatorGives holds these figures to the estimator's.
std::vector<CalibrationPrint> prints_by(const Profile& truth, const std::vector<PrintTerms>& all) {
  std::vector<CalibrationPrint> prints;
  for (const PrintTerms& terms : all) {
    const double support_g = support_g_of(truth, terms);
    prints.push_back({"block", terms, time_of(truth, terms), model_g_of(truth, terms),
                      support_g > 0 ? std::optional(support_g) : std::nullopt});
  }
  return prints;
}

double any_between(double low, double high) {
  return low + (high - low) * *rc::gen::inRange(0, 1001) / 1000.0;
}

Profile any_polyjet() {
  Profile truth = fixtures::plain_polyjet();
  truth.polyjet.start_s = any_between(0, 900);
  truth.polyjet.layer_s = any_between(0.5, 20);
  truth.polyjet.swath_s = any_between(0.5, 20);
  truth.polyjet.per_mm_x_s = any_between(0, 0.5);
  truth.polyjet.support_g_per_cm3 = any_between(0.5, 4);
  truth.polyjet.model_waste_factor = any_between(1, 3);
  return truth;
}

Profile any_deposition() {
  Profile truth = fixtures::plain_deposition();
  truth.fdm.start_s = any_between(0, 900);
  truth.fdm.deposition_cm3_h = any_between(1, 60);
  truth.fdm.layer_s = any_between(0.5, 40);
  truth.fdm.support_fill_fraction = any_between(0.1, 1);
  return truth;
}

void scatter(std::vector<CalibrationPrint>& prints, double spread, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> off(1 - spread, 1 + spread);
  for (CalibrationPrint& print : prints) {
    *print.time_s *= off(random);
    *print.model_g *= off(random);
    if (print.support_g) *print.support_g *= off(random);
  }
}

TEST(PrintTerms, GiveWhatTheEstimatorGives) {
  EXPECT_TRUE(rc::check([] {
    const Profile profile = *rc::gen::arbitrary<bool>() ? any_polyjet() : any_deposition();
    const Block block{Vec3(any_between(1, 40), any_between(1, 40), any_between(1, 40)),
                      any_between(0, 5)};
    const std::vector<Tray> trays(static_cast<std::size_t>(*rc::gen::inRange(1, 4)),
                                  tray_of(block));
    const Estimate whole = estimate(profile, trays, {}, Progress());
    const PrintTerms terms = print_terms(profile, trays, Progress());
    RC_ASSERT(std::abs(time_of(profile, terms) / whole.time_s - 1) < 1e-9);
    RC_ASSERT(std::abs(model_g_of(profile, terms) / whole.model_g - 1) < 1e-9);
    RC_ASSERT(std::abs(support_g_of(profile, terms) - whole.support_g) < 1e-9);
  }));
}

// A block fills whole layers, so that the packer's view of a tray is not coarser than the others'.
TEST(LinearEstimate, EstimatePackerAndCalibrationAgree) {
  const Profile jet = fixtures::plain_polyjet();
  const Profile fdm = fixtures::plain_deposition();
  const std::vector<PrintTerms> by_jet = varied_terms(jet);
  const std::vector<PrintTerms> by_fdm = varied_terms(fdm);
  EXPECT_TRUE(rc::check([&] {
    Profile truth = *rc::gen::arbitrary<bool>() ? any_polyjet() : any_deposition();
    truth.pack.objective = Objective::kPrinter;
    truth.cost.model_price_per_g = any_between(0, 1);
    truth.cost.support_price_per_g = any_between(0, 1);
    truth.cost.machine_price_per_h = any_between(0, 50);
    truth.cost.labour_price_per_h = any_between(0, 50);
    const Block block{
        Vec3(any_between(1, 40), any_between(1, 40), truth.layer_mm * *rc::gen::inRange(1, 100)),
        truth.layer_mm * *rc::gen::inRange(1, 10)};
    const Estimate whole = estimate(truth, {tray_of(block)}, {1, 0}, Progress());
    const Vec3 box = block.size_mm + Vec3(0, 0, block.lift_mm);
    const double packed =
        packing_cost(truth).evaluate({box, whole.support_mm3, block.size_mm.prod(), 1});
    RC_ASSERT(std::abs(packed - whole.cost) < 1e-6 * (1 + whole.cost));

    // prints of that machine teach a shipped profile to predict it
    const bool is_jet = truth.technology == Technology::kPolyjet;
    const Profile taught =
        calibrate(is_jet ? jet : fdm, prints_by(truth, is_jet ? by_jet : by_fdm)).profile;
    const Estimate again = estimate(taught, {tray_of(block)}, {1, 0}, Progress());
    RC_ASSERT(std::abs(again.time_s / whole.time_s - 1) < 1e-4);
    RC_ASSERT(std::abs(again.support_g / whole.support_g - 1) < 1e-4);
  }));
}

TEST(PrintTerms, OfATool) {
  Profile profile = fixtures::plain_toolpath();
  profile.fdm.start_s = 300;
  const std::vector<Tray> trays(2, tray_of({Vec3(20, 20, 5), 0}));
  EXPECT_NEAR(time_of(profile, print_terms(profile, trays, Progress())),
              estimate(profile, trays, {}, Progress()).time_s, 1e-6);
}

TEST(Calibrate, FindsThePolyjetConstantsThatMadeThePrints) {
  const Profile before = fixtures::plain_polyjet();
  const std::vector<PrintTerms> measured = varied_terms(before);
  EXPECT_TRUE(rc::check([&] {
    const Profile truth = any_polyjet();
    const Calibration fit = calibrate(before, prints_by(truth, measured));
    RC_ASSERT(quantity(fit, "time").rms_after < 1e-5);
    RC_ASSERT(quantity(fit, "support").rms_after < 1e-5);
    const PolyjetSettings& found = fit.profile.polyjet;
    for (const auto& [is, was] :
         {std::pair{found.layer_s, truth.polyjet.layer_s},
          std::pair{found.swath_s, truth.polyjet.swath_s},
          std::pair{found.support_g_per_cm3, truth.polyjet.support_g_per_cm3},
          std::pair{found.model_waste_factor, truth.polyjet.model_waste_factor}})
      RC_ASSERT(std::abs(is / was - 1) < 1e-4);
    RC_ASSERT(std::abs(found.start_s - truth.polyjet.start_s) < 0.1);
    RC_ASSERT(std::abs(found.per_mm_x_s - truth.polyjet.per_mm_x_s) < 1e-4);
  }));
}

TEST(Calibrate, FindsTheDepositionConstantsThatMadeThePrints) {
  const Profile before = fixtures::plain_deposition();
  const std::vector<PrintTerms> measured = varied_terms(before);
  EXPECT_TRUE(rc::check([&] {
    const Profile truth = any_deposition();
    const Calibration fit = calibrate(before, prints_by(truth, measured));
    const FdmSettings& found = fit.profile.fdm;
    RC_ASSERT(std::abs(found.support_fill_fraction / truth.fdm.support_fill_fraction - 1) < 1e-4);
    RC_ASSERT(std::abs(found.deposition_cm3_h / truth.fdm.deposition_cm3_h - 1) < 1e-3);
    RC_ASSERT(std::abs(found.layer_s - truth.fdm.layer_s) < 0.05);
    RC_ASSERT(std::abs(found.start_s - truth.fdm.start_s) < 2);
    RC_ASSERT(quantity(fit, "time").rms_after < 1e-4);
  }));
}

TEST(Calibrate, ScatteredPrintsLieWithinTheErrorsItTells) {
  const Profile before = fixtures::plain_polyjet();
  std::vector<PrintTerms> measured = varied_terms(before);
  for (int twice = 0; twice < 2; ++twice)
    for (std::size_t i = 0; i < 6; ++i) measured.push_back(measured[i]);
  EXPECT_TRUE(rc::check([&] {
    const Profile truth = any_polyjet();
    std::vector<CalibrationPrint> prints = prints_by(truth, measured);
    scatter(prints, 0.03, *rc::gen::arbitrary<std::uint32_t>());
    const Calibration fit = calibrate(before, prints);
    for (const auto& [key, was] :
         {std::pair{"polyjet.layer_s", truth.polyjet.layer_s},
          std::pair{"polyjet.swath_s", truth.polyjet.swath_s},
          std::pair{"polyjet.start_s", truth.polyjet.start_s},
          std::pair{"polyjet.support_g_per_cm3", truth.polyjet.support_g_per_cm3},
          std::pair{"polyjet.model_waste_factor", truth.polyjet.model_waste_factor}}) {
      const CalibratedConstant& found = constant(fit, key);
      if (!found.standard_error) continue;  // at a limit of its range
      RC_ASSERT(std::abs(found.after - was) < 8 * *found.standard_error + 1e-9);
    }
    const QuantityFit& time = quantity(fit, "time");
    RC_ASSERT(time.rms_after < 0.03);
    RC_ASSERT(time.rms_left_out.value() < 0.06);
    RC_ASSERT(time.rms_left_out.value() >= time.rms_after);
  }));
}

TEST(Calibrate, NoConstantEverLeavesItsRange) {
  EXPECT_TRUE(rc::check([] {
    const bool jets = *rc::gen::arbitrary<bool>();
    const Profile before = jets ? fixtures::plain_polyjet() : fixtures::plain_deposition();
    std::vector<CalibrationPrint> prints;
    for (int count = *rc::gen::inRange(1, 8); count > 0; --count) {
      PrintTerms terms;
      terms.trays = *rc::gen::inRange(1, 4);
      terms.layers = *rc::gen::inRange(1, 10000);
      terms.passes = terms.layers * any_between(1, 8);
      terms.passes_mm = terms.passes * any_between(1, 300);
      terms.model_mm3 = std::pow(10.0, any_between(0, 6));
      terms.support_mm3 = std::pow(10.0, any_between(0, 6));
      // whatever somebody may type
      const auto typed = [] { return std::pow(10.0, any_between(-4, 8)); };
      prints.push_back({"typed", terms, typed(), typed(), typed()});
    }
    const Calibration fit = calibrate(before, prints);
    // a profile's reader takes what was found
    Profile again = before;
    for (const CalibratedConstant& one : fit.constants) {
      RC_ASSERT(std::isfinite(one.after));
      set_profile_key(again, one.key + "=" + std::to_string(one.after));
    }
    check_settings(fit.profile);
  }));
}

TEST(Calibrate, OnePrintFitsOneFactor) {
  Profile truth = fixtures::plain_polyjet();
  truth.polyjet.layer_s *= 1.3;
  truth.polyjet.swath_s *= 1.3;
  truth.polyjet.per_mm_x_s *= 1.3;
  const Profile before = fixtures::plain_polyjet();
  const Calibration fit = calibrate(before, {print_of(truth, before, {Vec3(30, 25, 40), 2})});
  EXPECT_NEAR(fit.profile.polyjet.layer_s, 1.3, 1e-5);
  EXPECT_NEAR(fit.profile.polyjet.swath_s, 2.6, 1e-5);
  EXPECT_NEAR(fit.profile.polyjet.per_mm_x_s, 0.13, 1e-5);
  EXPECT_EQ(fit.profile.polyjet.start_s, before.polyjet.start_s);
  EXPECT_THAT(constant(fit, "polyjet.layer_s").why, HasSubstr("one factor"));
  EXPECT_FALSE(constant(fit, "polyjet.start_s").fitted);
  EXPECT_THAT(constant(fit, "polyjet.start_s").why, HasSubstr("3 prints"));
  EXPECT_FALSE(constant(fit, "polyjet.layer_s").standard_error);
  EXPECT_FALSE(quantity(fit, "time").rms_left_out);
  ASSERT_FALSE(fit.warnings.empty());
  EXPECT_EQ(fit.warnings.back().code, "no_print_left");
}

TEST(Calibrate, PrintsOfOneWidthDoNotTellLayersFromPasses) {
  Profile truth = fixtures::plain_polyjet();
  truth.polyjet.layer_s = 3;
  truth.polyjet.start_s = 0;
  Profile before = truth;
  before.polyjet.layer_s = 1;
  std::vector<CalibrationPrint> prints;
  for (const double height : {20.0, 40.0, 60.0})
    prints.push_back(print_of(truth, before, {Vec3(20, 25, height), 0}));
  const Calibration fit = calibrate(before, prints);
  EXPECT_THAT(constant(fit, "polyjet.swath_s").why, HasSubstr("do not tell"));
  EXPECT_NEAR(fit.profile.polyjet.swath_s / fit.profile.polyjet.layer_s, 2, 1e-4);
  EXPECT_LT(quantity(fit, "time").rms_after, 1e-5) << "and yet the times are right";
}

TEST(Calibrate, ASlicedProfileFitsItsStart) {
  Profile profile = fixtures::plain_toolpath();
  profile.dialect = Dialect::kGcode;
  std::vector<CalibrationPrint> prints;
  for (const double sliced_s : {600.0, 1200.0, 1800.0}) {
    PrintTerms terms;
    terms.path_s = sliced_s;
    prints.push_back({"sliced", terms, sliced_s + 240, 12.0, {}});
  }
  const Calibration fit = calibrate(profile, prints);
  EXPECT_NEAR(fit.profile.fdm.start_s, 240, 1e-3);
  EXPECT_NEAR(constant(fit, "fdm.start_s").standard_error.value(), 0, 1e-3);
  EXPECT_EQ(fit.constants.size(), 1U);
  ASSERT_EQ(fit.warnings.size(), 1U);
  EXPECT_EQ(fit.warnings[0].code, "no_such_constant");
}

TEST(Calibrate, AMachineFasterThanItsSlicerKeepsToTheRange) {
  Profile profile = fixtures::plain_toolpath();
  profile.dialect = Dialect::kGcode;
  profile.fdm.start_s = 100;
  PrintTerms terms;
  terms.path_s = 1000;
  const Calibration fit = calibrate(profile, {{"fast", terms, 900.0, {}, {}}});
  EXPECT_EQ(fit.profile.fdm.start_s, 0);
  EXPECT_TRUE(constant(fit, "fdm.start_s").at_limit);
}

TEST(Calibrate, LeavingOutByHand) {
  // one constant: the fit to the two others is the mean weighted by 1 / seen²
  Profile profile = fixtures::plain_polyjet();
  std::vector<CalibrationPrint> prints;
  for (const double grams : {1.0, 2.0, 4.0}) {
    PrintTerms terms;
    terms.by = Estimator::kPolyjet;
    terms.held_mm3 = 1000;
    prints.push_back({"print", terms, {}, {}, grams});
  }
  const auto fitted = [](double a, double b) {
    return (1 / a + 1 / b) / (1 / (a * a) + 1 / (b * b));
  };
  const QuantityFit support = quantity(calibrate(profile, prints), "support");
  ASSERT_EQ(support.prints.size(), 3U);
  EXPECT_NEAR(support.prints[0].left_out.value(), fitted(2, 4), 1e-5);
  EXPECT_NEAR(support.prints[1].left_out.value(), fitted(1, 4), 1e-5);
  EXPECT_NEAR(support.prints[2].left_out.value(), fitted(1, 2), 1e-5);
  EXPECT_NEAR(support.prints[0].before, 2, 1e-12);
}

TEST(Calibrate, WhatTellsNothingIsRefused) {
  const Profile profile = fixtures::plain_polyjet();
  CalibrationPrint silent = print_of(profile, profile, {Vec3(20, 20, 20), 0});
  silent.time_s = silent.model_g = std::nullopt;
  for (const std::vector<CalibrationPrint>& prints : {std::vector<CalibrationPrint>{}, {silent}}) {
    try {
      calibrate(profile, prints);
      ADD_FAILURE() << "fitted " << prints.size();
    } catch (const Error& error) {
      EXPECT_EQ(error.fault(), Fault::kBadInput);
      EXPECT_THAT(error.hint(), HasSubstr("--took"));
    }
  }
}

TEST(Calibrate, SupportWhereNoneIsNeededTeachesNothing) {
  const Profile profile = fixtures::plain_polyjet();
  CalibrationPrint print = print_of(profile, profile, {Vec3(20, 20, 20), 0});
  print.support_g = 5;
  const Calibration fit = calibrate(profile, {print});
  EXPECT_FALSE(constant(fit, "polyjet.support_g_per_cm3").fitted);
  EXPECT_EQ(fit.profile.polyjet.support_g_per_cm3, profile.polyjet.support_g_per_cm3);
  EXPECT_EQ(fit.warnings.front().code, "nothing_predicted");
}

TEST(Calibrate, AWrongSizeIsNoticed) {
  const Profile profile = fixtures::plain_polyjet();
  CalibrationPrint print = print_of(profile, profile, {Vec3(20, 20, 20), 0});
  *print.time_s *= 25;
  const Calibration fit = calibrate(profile, {print});
  EXPECT_EQ(fit.warnings.front().code, "far_off");
}

}  // namespace
}  // namespace packmerger
