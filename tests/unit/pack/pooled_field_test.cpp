#include "pack/drop/pooled_field.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <array>
#include <limits>
#include <vector>

#include "base/random.h"
#include "pack/drop/fall.h"

namespace packmerger {
namespace {

struct Falling {
  HeightField field;
  std::vector<HeightCell> cells;
  int width = 0;
  int height = 0;
};

Falling random_falling(Random& random) {
  constexpr int kBorder = 3;
  const int width = 20 + static_cast<int>(random.below(200));
  const int height = 10 + static_cast<int>(random.below(20));
  Falling falling{HeightField(width, height, kBorder, kBarePlate), {}, width, height};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      if (random.below(3) > 0) falling.field.at(x, y) = static_cast<Height>(random.below(2000));
  for (int y = -kBorder; y < 8; ++y)
    for (int x = -kBorder; x < 8; ++x)
      if (random.below(3) == 0)
        falling.cells.push_back({static_cast<std::int16_t>(x), static_cast<std::int16_t>(y),
                                 static_cast<Height>(random.below(500))});
  return falling;
}

// Where the part comes to lie at one position, by plain loops.
int height_at(Falling& falling, int x, int y) {
  int height = 0;
  for (const HeightCell& cell : falling.cells)
    height = std::max(height, falling.field.at(x + cell.x, y + cell.y) - cell.value);
  return height;
}

// No group is bounded above any of its positions, wherever the groups begin.
RC_GTEST_PROP(PooledField, BoundsEveryPositionOfAGroup, (std::uint64_t seed)) {
  Random random(seed);
  Falling falling = random_falling(random);
  const int positions_x = falling.width - 7;
  const int positions_y = falling.height - 7;
  const int first_x = static_cast<int>(random.below(static_cast<std::size_t>(positions_x)));
  const int first_y = static_cast<int>(random.below(static_cast<std::size_t>(positions_y)));
  const PooledField pooled(falling.field);
  std::vector<HeightCell> cells;
  for (const HeightCell& cell : falling.cells) cells.push_back(pooled.cell(cell, first_x));
  for (int y = first_y; y < positions_y; y += kPool) {
    std::array<Height, kFallPositions> bounds{};
    std::array blocks{FallBlock{pooled.row(y), bounds.data(), std::numeric_limits<Height>::max()}};
    fall(blocks, pooled.stride(), cells);
    for (int group = 0; group < kFallPositions; ++group)
      for (int dy = 0; dy < kPool; ++dy)
        for (int dx = 0; dx < kPool; ++dx) {
          const int at_x = first_x + group * kPool + dx;
          if (at_x >= positions_x || y + dy >= positions_y) continue;
          RC_ASSERT(bounds[static_cast<std::size_t>(group)] <= height_at(falling, at_x, y + dy));
        }
  }
}

TEST(PooledField, OfFlatGroundIsTheGround) {
  Falling falling{HeightField(160, 12, 1, kBarePlate), {{0, 0, 5}, {2, 1, 0}}, 160, 12};
  for (int y = 0; y < falling.height; ++y)
    for (int x = 0; x < falling.width; ++x) falling.field.at(x, y) = 70;
  const PooledField pooled(falling.field);
  std::array<Height, kFallPositions> bounds{};
  std::vector<HeightCell> cells;
  for (const HeightCell& cell : falling.cells) cells.push_back(pooled.cell(cell, 2));
  std::array blocks{FallBlock{pooled.row(3), bounds.data(), std::numeric_limits<Height>::max()}};
  EXPECT_EQ(fall(blocks, pooled.stride(), cells), 1);
  for (const Height bound : bounds) EXPECT_EQ(bound, 70);
}

}  // namespace
}  // namespace packmerger
