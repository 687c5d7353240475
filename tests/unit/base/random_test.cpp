#include "base/random.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "base/parallel.h"

namespace packmerger {
namespace {

TEST(Random, SameSeedSameNumbers) {
  Random a(7), b(7), c(8);
  EXPECT_EQ(a.bits(), b.bits());
  EXPECT_NE(a.bits(), c.bits());
  EXPECT_EQ(Random(1).bits(), 2469588189546311528u) << "the sequence is fixed by the standard";
}

TEST(Random, StaysInRange) {
  Random random(1);
  for (int i = 0; i < 10000; ++i) {
    EXPECT_LT(random.below(3), 3u);
    const double unit = random.unit();
    EXPECT_GE(unit, 0);
    EXPECT_LT(unit, 1);
  }
}

TEST(Random, ShuffleKeepsEveryItem) {
  std::vector<int> items(100);
  std::iota(items.begin(), items.end(), 0);
  const std::vector<int> before = items;
  Random(3).shuffle(items);
  EXPECT_NE(items, before);
  std::sort(items.begin(), items.end());
  EXPECT_EQ(items, before);
}

TEST(Parallel, CallsEachIndexOnce) {
  for (const std::size_t threads : {1, 2}) {
    const ThreadLimit limit(threads);
    std::vector<int> calls(1000);
    parallel_for(calls.size(), [&](std::size_t i) { ++calls[i]; });
    EXPECT_EQ(calls, std::vector<int>(1000, 1));
  }
}

}  // namespace
}  // namespace packmerger
