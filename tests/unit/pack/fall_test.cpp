// The placement kernel against its formula, on every kind of vectors that this processor has.
#include "pack/drop/fall.h"

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

// Heights of all positions, in blocks; behind the last position of a row nothing counts.
struct Blocks {
  Blocks(const Scene& scene, Height limit)
      : heights(static_cast<std::size_t>((scene.n + kFallPositions - 1) / kFallPositions *
                                         kFallPositions),
                32767) {
    std::fill_n(heights.begin(), scene.n, scene.floor);
    for (int first = 0; first < scene.n; first += kFallPositions)
      blocks.push_back({scene.origin() + scene.y * scene.stride + scene.x + first,
                        &heights[static_cast<std::size_t>(first)], limit});
  }
  std::vector<Height> heights;
  std::vector<FallBlock> blocks;
};

RC_GTEST_PROP(Fall, IsTheHighestOfTheDifferences, (std::uint64_t seed)) {
  Random random(seed);
  const Scene scene(random);
  const std::vector<Height> expected = scene.fallen();
  on_every_target([&](const char* target) {
    RC_LOG() << target;
    Blocks all(scene, 32767);
    RC_ASSERT(fall(all.blocks, scene.stride, scene.cells) == all.blocks.size());
    RC_ASSERT(std::equal(expected.begin(), expected.end(), all.heights.begin()));
    RC_ASSERT(std::all_of(all.heights.begin() + scene.n, all.heights.end(),
                          [](Height height) { return height == 32767; }));
  });
}

RC_GTEST_PROP(Fall, GivesUpOnlyBlocksWhoseHeightsAreAllTooHigh, (std::uint64_t seed)) {
  Random random(seed);
  const Scene scene(random);
  const std::vector<Height> expected = scene.fallen();
  // Above the limit there must be room for what lies behind the last position.
  const auto limit = static_cast<Height>(
      std::min(32766, expected[random.below(expected.size())] - static_cast<int>(random.below(3))));
  on_every_target([&](const char* target) {
    RC_LOG() << target;
    Blocks all(scene, limit);
    const std::vector<FallBlock> given = all.blocks;
    const std::size_t kept = fall(all.blocks, scene.stride, scene.cells);
    std::size_t next = 0;
    for (std::size_t b = 0; b < given.size(); ++b) {
      const std::size_t begin = b * kFallPositions;
      const std::size_t end = std::min(expected.size(), begin + kFallPositions);
      const bool low = std::any_of(expected.begin() + static_cast<std::ptrdiff_t>(begin),
                                   expected.begin() + static_cast<std::ptrdiff_t>(end),
                                   [limit](Height height) { return height <= limit; });
      if (low) {
        RC_ASSERT(next < kept);
        RC_ASSERT(all.blocks[next].field == given[b].field);
        RC_ASSERT(all.blocks[next++].heights == given[b].heights);
      }
      for (std::size_t i = begin; i < end; ++i)
        if (low)
          RC_ASSERT(all.heights[i] == expected[i]);
        else
          RC_ASSERT(all.heights[i] > limit && all.heights[i] <= expected[i]);
    }
    RC_ASSERT(next == kept);
  });
}

TEST(Fall, SavesTheRestOfTheCellsOnceAllAreTooHigh) {
  // The last cell alone would raise the height to 900.
  const std::vector<Height> field(1000, 100);
  std::vector<HeightCell> cells(500, HeightCell{0, 0, 0});
  cells.push_back({0, 0, -800});
  on_every_target([&](const char* target) {
    std::vector<Height> heights(2 * kFallPositions);
    std::vector<FallBlock> blocks{{field.data(), heights.data(), 50},
                                  {field.data(), &heights[kFallPositions], 1000}};
    EXPECT_EQ(fall(blocks, 100, cells), 1U) << target;
    EXPECT_EQ(blocks[0].heights, &heights[kFallPositions]) << target;
    std::vector<Height> expected(kFallPositions, 100);
    expected.resize(2 * kFallPositions, 900);
    EXPECT_EQ(heights, expected) << target;
  });
}

RC_GTEST_PROP(SumField, IsTheSumOfWhatIsAboveZero, (std::uint64_t seed)) {
  Random random(seed);
  const Scene scene(random);
  on_every_target([&](const char* target) {
    RC_LOG() << target;
    const Blocks all(scene, 0);
    std::vector<std::int64_t> sums(all.heights.size() + 1, -77);
    sum_field(all.blocks, scene.stride, scene.cells, sums.data());
    for (int i = 0; i < scene.n; ++i) {
      std::int64_t expected = 0;
      for (const HeightCell& cell : scene.cells) expected += std::max(0, scene.at(cell, i));
      RC_ASSERT(sums[static_cast<std::size_t>(i)] == expected);
    }
    RC_ASSERT(sums.back() == -77);
  });
}

// As of the underside of a plate over a whole tray on the finest grid.
TEST(SumField, HoldsAnyNumberOfCells) {
  constexpr std::int64_t kHigh = 32767;
  const std::vector<Height> field(200, kHigh);
  const std::vector<FallBlock> blocks(3, {field.data(), nullptr, 0});
  for (const std::int64_t count : {65536, 65537, 200001}) {
    const std::vector<HeightCell> cells(static_cast<std::size_t>(count));
    on_every_target([&](const char* target) {
      std::vector<std::int64_t> sums(3 * kFallPositions);
      sum_field(blocks, 100, cells, sums.data());
      EXPECT_EQ(sums, std::vector<std::int64_t>(3 * kFallPositions, count * kHigh)) << target;
    });
  }
}

}  // namespace
}  // namespace packmerger
