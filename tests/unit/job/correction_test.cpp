#include "job/store/correction.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <cmath>
#include <limits>
#include <random>

namespace packmerger {
namespace {

// Prints of a printer that takes `factor` times as long, give or take `spread`.
std::vector<FinishedPrint> prints_of(double factor, double spread, int count, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> scatter(0, spread);
  std::uniform_real_distribution<double> hours(0.2, 30);
  std::vector<FinishedPrint> prints;
  for (int i = 0; i < count; ++i) {
    const double predicted_s = 3600 * hours(random);
    prints.push_back({predicted_s, predicted_s * factor * std::exp(scatter(random))});
  }
  return prints;
}

double width(const Correction& correction) { return std::log(correction.high / correction.low); }

TEST(Correction, FewPrintsTeachNothing) {
  for (int count = 0; count < kLeastPrints; ++count)
    EXPECT_FALSE(learn_correction(prints_of(1.2, 0.1, count, 1))) << count;
  EXPECT_TRUE(learn_correction(prints_of(1.2, 0.1, kLeastPrints, 1)));
}

TEST(Correction, OfThreePrintsByHand) {
  const Correction told =
      learn_correction({{100, 100}, {100, 110}, {100, 121}}).value_or(Correction{});
  EXPECT_NEAR(told.factor, 1.1, 1e-9);
  // scatter ln 1.1, t(2) = 4.303
  EXPECT_NEAR(std::log(told.high / told.factor), 4.303 * std::log(1.1) / std::sqrt(3), 1e-9);
  EXPECT_NEAR(told.factor / told.low, told.high / told.factor, 1e-9);
  EXPECT_EQ(told.prints, 3);
  EXPECT_EQ(told.left_out, 0);
}

TEST(Correction, Converges) {
  EXPECT_TRUE(rc::check([] {
    const double factor = *rc::gen::inRange(50, 300) / 100.0;
    const double spread = *rc::gen::inRange(2, 25) / 100.0;
    const auto seed = *rc::gen::arbitrary<std::uint32_t>();
    const Correction few = learn_correction(prints_of(factor, spread, 10, seed)).value();
    const Correction many = learn_correction(prints_of(factor, spread, 1000, seed)).value();
    // six standard errors: one case in half a thousand million
    RC_ASSERT(std::abs(std::log(many.factor / factor)) < 6 * spread / std::sqrt(1000.0) + 1e-9);
    RC_ASSERT(width(many) < width(few));
    RC_ASSERT(many.low < many.factor && many.factor < many.high);
  }));
}

TEST(Correction, TheErrorBarHoldsTheTruthNineteenTimesInTwenty) {
  int held = 0;
  constexpr int kTrials = 2000;
  for (std::uint32_t trial = 0; trial < kTrials; ++trial) {
    const Correction told = learn_correction(prints_of(1.3, 0.1, 8, trial)).value();
    held += told.low <= 1.3 && 1.3 <= told.high ? 1 : 0;
  }
  EXPECT_GT(held, 0.92 * kTrials) << held;
  EXPECT_LT(held, 0.97 * kTrials) << held;
}

TEST(Correction, OneOutlierDoesNotWreckIt) {
  EXPECT_TRUE(rc::check([] {
    const double factor = *rc::gen::inRange(50, 300) / 100.0;
    const double spread = *rc::gen::inRange(1, 15) / 100.0;
    const int count = *rc::gen::inRange(5, 60);
    std::vector<FinishedPrint> prints =
        prints_of(factor, spread, count, *rc::gen::arbitrary<std::uint32_t>());
    const Correction clean = learn_correction(prints).value();
    const double off = std::pow(10.0, *rc::gen::inRange(-6, 7));
    prints.push_back({3600, 3600 * factor * off});
    const Correction told = learn_correction(prints).value();
    // whatever it is, the answer moves by less than the prints themselves scatter
    RC_ASSERT(std::abs(std::log(told.factor / clean.factor)) < 3 * std::max(spread, 0.05));
  }));
}

TEST(Correction, NonsenseIsPassedOver) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  std::vector<FinishedPrint> prints = {{0, 1},   {1, 0},   {-1, 1},  {1, -1}, {nan, 1},
                                       {1, nan}, {inf, 1}, {1, inf}, {0, 0},  {-1, -1}};
  EXPECT_FALSE(learn_correction(prints));
  for (const FinishedPrint& print : prints_of(1, 0, 3, 1)) prints.push_back(print);
  const Correction told = learn_correction(prints).value();
  EXPECT_EQ(told.prints, 3);
  EXPECT_NEAR(told.factor, 1, 1e-9);
  EXPECT_LT(told.low, 1) << "three equal prints are no certainty";
}

}  // namespace
}  // namespace packmerger
