#include "pack/drop/fall.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>
#include <vector>

#include "base/simd_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pack/drop/fall.cpp"
#include <hwy/foreach_target.h>  // includes this file once for each target

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace packmerger::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr hn::CappedTag<Height, kFallPositions> kHeights;
using Heights = hn::VFromD<decltype(kHeights)>;
constexpr int kLanes = static_cast<int>(hn::MaxLanes(kHeights));
constexpr int kVectorsOfBlock = kFallPositions / kLanes;
// So many blocks that their vectors stay in registers over all cells.
constexpr int kMostVectors = 8;
constexpr int kBlocksTogether = std::max(1, kMostVectors / kVectorsOfBlock);

// Calls loop(first block, number of them) with at most kMost blocks at once.
template <int kMost, typename Loop>
HWY_INLINE void in_groups(std::size_t count, const Loop& loop) {
  for (std::size_t first = 0; first < count; first += kMost) {
    const std::size_t blocks = std::min<std::size_t>(kMost, count - first);
    const auto run = [&]<int... kLess>(std::integer_sequence<int, kLess...>) HWY_ATTR {
      static_cast<void>(
          ((blocks == kLess + 1 && (loop(first, std::integral_constant<int, kLess + 1>{}), true)) ||
           ...));
    };
    run(std::make_integer_sequence<int, kMost>{});
  }
}

template <int kBlocks>
HWY_INLINE void raise_together(const FallBlock* blocks, std::ptrdiff_t stride,
                               std::span<const HeightCell> cells) {
  constexpr int kVectors = kBlocks * kVectorsOfBlock;
  Heights height[kVectors];
  const Height* fields[kBlocks];
  for (int b = 0; b < kBlocks; ++b) fields[b] = blocks[b].field;
  for (int v = 0; v < kVectors; ++v)
    height[v] =
        hn::LoadU(kHeights, blocks[v / kVectorsOfBlock].heights + v % kVectorsOfBlock * kLanes);
  for (const HeightCell cell : cells) {
    const std::ptrdiff_t at = cell.y * stride + cell.x;
    const Heights value = hn::Set(kHeights, cell.value);
    for (int v = 0; v < kVectors; ++v) {
      const Height* below = fields[v / kVectorsOfBlock] + at + v % kVectorsOfBlock * kLanes;
      height[v] = hn::Max(height[v], hn::SaturatedSub(hn::LoadU(kHeights, below), value));
    }
  }
  for (int v = 0; v < kVectors; ++v)
    hn::StoreU(height[v], kHeights,
               blocks[v / kVectorsOfBlock].heights + v % kVectorsOfBlock * kLanes);
}

HWY_INLINE bool all_above_limit(const FallBlock& block) {
  Heights least = hn::LoadU(kHeights, block.heights);
  for (int v = 1; v < kVectorsOfBlock; ++v)
    least = hn::Min(least, hn::LoadU(kHeights, block.heights + v * kLanes));
  return hn::AllTrue(kHeights, hn::Gt(least, hn::Set(kHeights, block.give_up_above)));
}

HWY_INLINE std::size_t worth_going_on(std::span<FallBlock> blocks) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < blocks.size(); ++i)
    if (!all_above_limit(blocks[i])) std::swap(blocks[kept++], blocks[i]);
  return kept;
}

std::size_t fall(std::span<FallBlock> blocks, std::ptrdiff_t stride,
                 std::span<const HeightCell> cells) {
  std::size_t kept = worth_going_on(blocks);
  // A look costs about as much as a cell. The first come early: few cells rule out most blocks.
  std::size_t before_look = 8;
  for (std::size_t next = 0; next < cells.size() && kept > 0; before_look *= 2) {
    const auto some = cells.subspan(next, std::min(before_look, cells.size() - next));
    in_groups<kBlocksTogether>(kept, [&](std::size_t first, auto count) HWY_ATTR {
      raise_together<count()>(&blocks[first], stride, some);
    });
    kept = worth_going_on(blocks.first(kept));
    next += some.size();
  }
  return kept;
}

#if HWY_TARGET != HWY_SCALAR
// Two heights that are not negative fit into 16 bits together; even and odd positions are then
// counted in 32 bits each, which needs no lanes to change their places.
constexpr hn::RebindToUnsigned<decltype(kHeights)> kPairs;
constexpr hn::RepartitionToWide<decltype(kPairs)> kSums;
using Sums = hn::VFromD<decltype(kSums)>;

template <int kBlocks>
HWY_INLINE void sum_together(const FallBlock* blocks, std::ptrdiff_t stride,
                             std::span<const HeightCell> cells, std::int32_t* sums) {
  constexpr int kVectors = kBlocks * kVectorsOfBlock;
  const auto above_zero = [&](const HeightCell& cell, int v) HWY_ATTR {
    const Height* below =
        blocks[v / kVectorsOfBlock].field + cell.y * stride + cell.x + v % kVectorsOfBlock * kLanes;
    return hn::BitCast(kPairs, hn::Max(hn::LoadU(kHeights, below), hn::Zero(kHeights)));
  };
  Sums even[kVectors];
  Sums odd[kVectors];
  for (int v = 0; v < kVectors; ++v) even[v] = odd[v] = hn::Zero(kSums);
  const auto count = [&](auto pair, int v) HWY_ATTR {
    const Sums both = hn::BitCast(kSums, pair);
    even[v] = hn::Add(even[v], hn::And(both, hn::Set(kSums, 0xFFFF)));
    odd[v] = hn::Add(odd[v], hn::ShiftRight<16>(both));
  };
  std::size_t next = 0;
  for (; next + 1 < cells.size(); next += 2)
    for (int v = 0; v < kVectors; ++v)
      count(hn::Add(above_zero(cells[next], v), above_zero(cells[next + 1], v)), v);
  if (next < cells.size())
    for (int v = 0; v < kVectors; ++v) count(above_zero(cells[next], v), v);

  HWY_ALIGN std::array<std::uint32_t, kLanes> lanes;  // the even ones, then the odd ones
  for (int v = 0; v < kVectors; ++v) {
    hn::Store(even[v], kSums, lanes.data());
    hn::Store(odd[v], kSums, lanes.data() + kLanes / 2);
    for (int i = 0; i < kLanes; ++i)
      sums[v * kLanes + i] =
          static_cast<std::int32_t>(lanes[static_cast<std::size_t>(i / 2 + i % 2 * (kLanes / 2))]);
  }
}

// For up to kCellsOfSum cells.
void sum_some(std::span<const FallBlock> blocks, std::ptrdiff_t stride,
              std::span<const HeightCell> cells, std::int32_t* sums) {
  in_groups<std::max(1, kBlocksTogether / 2)>(
      blocks.size(), [&](std::size_t first, auto count) HWY_ATTR {
        sum_together<count()>(&blocks[first], stride, cells,
                              sums + first * static_cast<std::size_t>(kFallPositions));
      });
}

#else

void sum_some(std::span<const FallBlock> blocks, std::ptrdiff_t stride,
              std::span<const HeightCell> cells, std::int32_t* sums) {
  for (const FallBlock& block : blocks) {
    std::fill_n(sums, kFallPositions, 0);
    for (const HeightCell& cell : cells) {
      const Height* below = block.field + cell.y * stride + cell.x;
      for (int i = 0; i < kFallPositions; ++i) sums[i] += std::max<Height>(0, below[i]);
    }
    sums += kFallPositions;
  }
}

#endif

}  // namespace packmerger::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace packmerger {
namespace {

// Their heights' sum stays in 32 bits.
constexpr std::size_t kCellsOfSum = 65536;
static_assert(kCellsOfSum * std::numeric_limits<Height>::max() <=
              std::numeric_limits<std::int32_t>::max());

}  // namespace

HWY_EXPORT(fall);
HWY_EXPORT(sum_some);

std::size_t fall(std::span<FallBlock> blocks, std::ptrdiff_t stride,
                 std::span<const HeightCell> cells) {
  return HWY_DYNAMIC_DISPATCH(fall)(blocks, stride, cells);
}

void sum_field(std::span<const FallBlock> blocks, std::ptrdiff_t stride,
               std::span<const HeightCell> cells, std::int64_t* sums) {
  const std::size_t count = blocks.size() * static_cast<std::size_t>(kFallPositions);
  std::fill_n(sums, count, 0);
  std::vector<std::int32_t> of_some(count);
  for (std::size_t first = 0; first < cells.size(); first += kCellsOfSum) {
    const auto some = cells.subspan(first, std::min(kCellsOfSum, cells.size() - first));
    HWY_DYNAMIC_DISPATCH(sum_some)(blocks, stride, some, of_some.data());
    for (std::size_t i = 0; i < count; ++i) sums[i] += of_some[i];
  }
}

}  // namespace packmerger
#endif  // HWY_ONCE
