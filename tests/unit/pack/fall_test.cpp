// The placement kernel against its formula, on every kind of vectors that this processor has.
#include "pack/fall.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include <rapidcheck/gtest.h>

#include "base/random.h"
#include "base/simd_targets.h"

#include <hwy/targets.h>

namespace packmerger {
namespace {

// Calls check() with the kernel held to one target after the other.
template <typename Check>
void on_every_target(const Check& check) {
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(target);
    check(hwy::TargetName(target));
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

// A field with room for any part of the scene at any of its positions.
struct Scene {
  explicit Scene(Random& random)
      : n(static_cast<int>(1 + random.below(300))),
        x(static_cast<int>(random.below(20))),
        y(static_cast<int>(random.below(20))),
        stride(kBorder + 40 + n + kFallReadAhead + static_cast<int>(random.below(7))),
        floor(any_height(random)) {
    field.resize(static_cast<std::size_t>(stride * (2 * kBorder + 40)));
    const bool extreme = random.below(2) == 0;
    for (Height& height : field)
      height = extreme ? any_height(random) : static_cast<Height>(random.below(500));
    cells.resize(random.below(400));
    for (HeightCell& cell : cells)
      cell = {near_zero(random), near_zero(random),
              extreme ? any_height(random) : static_cast<Height>(random.below(300))};
  }

  static std::int16_t near_zero(Random& random) {
    return static_cast<std::int16_t>(static_cast<int>(random.below(2 * kBorder)) - kBorder);
  }
  static Height any_height(Random& random) {
    return random.below(8) == 0 ? static_cast<Height>(random.below(2) == 0 ? -32768 : 32767)
                                : static_cast<Height>(random.bits());
  }
  const Height* origin() const {
    return &field[static_cast<std::size_t>(kBorder * stride + kBorder)];
  }
  int at(const HeightCell& cell, int i) const {
    return origin()[(y + cell.y) * stride + x + i + cell.x];
  }
  std::vector<Height> fallen() const {
    std::vector<Height> heights;
    for (int i = 0; i < n; ++i) {
      int height = floor;
      for (const HeightCell& cell : cells)
        height = std::max(height, std::clamp(at(cell, i) - cell.value, -32768, 32767));
      heights.push_back(static_cast<Height>(height));
    }
    return heights;
  }

  static constexpr int kBorder = 12;
  int n;
  int x;
  int y;
  int stride;
  Height floor;
  std::vector<Height> field;
  std::vector<HeightCell> cells;
};

// Results with something behind them that must stay as it is.
template <typename T>
std::vector<T> guarded(int n) {
  return std::vector<T>(static_cast<std::size_t>(n) + 40, T{-77});
}

template <typename T>
void expect_untouched_behind(const std::vector<T>& results, int n) {
  RC_ASSERT(std::all_of(results.begin() + n, results.end(), [](T value) { return value == -77; }));
}

RC_GTEST_PROP(Fall, IsTheHighestOfTheDifferences, (std::uint64_t seed)) {
  Random random(seed);
  const Scene scene(random);
  const std::vector<Height> expected = scene.fallen();
  on_every_target([&](const char* target) {
    RC_LOG() << target;
    std::vector<Height> heights = guarded<Height>(scene.n);
    fall(scene.origin(), scene.stride, scene.cells, scene.x, scene.y, scene.floor, 32767,
         heights.data(), scene.n);
    RC_ASSERT(std::equal(expected.begin(), expected.end(), heights.begin()));
    expect_untouched_behind(heights, scene.n);
  });
}

RC_GTEST_PROP(Fall, GivesUpOnlyWhereAllAreTooHigh, (std::uint64_t seed)) {
  Random random(seed);
  const Scene scene(random);
  const std::vector<Height> expected = scene.fallen();
  const Height limit =
      expected[random.below(expected.size())] - static_cast<Height>(random.below(3));
  on_every_target([&](const char* target) {
    RC_LOG() << target;
    std::vector<Height> heights = guarded<Height>(scene.n);
    fall(scene.origin(), scene.stride, scene.cells, scene.x, scene.y, scene.floor, limit,
         heights.data(), scene.n);
    for (std::size_t i = 0; i < expected.size(); ++i) {
      if (expected[i] <= limit)
        RC_ASSERT(heights[i] == expected[i]);
      else
        RC_ASSERT(heights[i] > limit && heights[i] <= expected[i]);
    }
    expect_untouched_behind(heights, scene.n);
  });
}

TEST(Fall, SavesTheRestOfTheCellsOnceAllAreTooHigh) {
  // The last cell alone would raise the height to 900.
  const std::vector<Height> field(1000, 100);
  std::vector<HeightCell> cells(500, HeightCell{0, 0, 0});
  cells.push_back({0, 0, -800});
  on_every_target([&](const char* target) {
    std::vector<Height> heights(64);
    fall(field.data(), 100, cells, 0, 0, 0, 50, heights.data(), 64);
    EXPECT_EQ(heights, std::vector<Height>(64, 100)) << target;
    fall(field.data(), 100, cells, 0, 0, 0, 100, heights.data(), 64);
    EXPECT_EQ(heights, std::vector<Height>(64, 900)) << target;
  });
}

RC_GTEST_PROP(SumField, IsTheSumOfWhatIsAboveZero, (std::uint64_t seed)) {
  Random random(seed);
  const Scene scene(random);
  on_every_target([&](const char* target) {
    RC_LOG() << target;
    std::vector<std::int32_t> sums = guarded<std::int32_t>(scene.n);
    sum_field(scene.origin(), scene.stride, scene.cells, scene.x, scene.y, sums.data(), scene.n);
    for (int i = 0; i < scene.n; ++i) {
      std::int32_t expected = 0;
      for (const HeightCell& cell : scene.cells) expected += std::max(0, scene.at(cell, i));
      RC_ASSERT(sums[static_cast<std::size_t>(i)] == expected);
    }
    expect_untouched_behind(sums, scene.n);
  });
}

TEST(SumField, HoldsTheMostCells) {
  const std::vector<Height> field(200, 32767);
  const std::vector<HeightCell> cells(65536);
  on_every_target([&](const char* target) {
    std::vector<std::int32_t> sums(3);
    sum_field(field.data(), 100, cells, 0, 0, sums.data(), 3);
    EXPECT_EQ(sums, std::vector<std::int32_t>(3, 65536 * 32767)) << target;
  });
}

}  // namespace
}  // namespace packmerger
