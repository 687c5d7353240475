#include "pack/fall.h"

#include <algorithm>
#include <array>
#include <utility>

#include "base/simd_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pack/fall.cpp"
#include <hwy/foreach_target.h>  // includes this file once for each target

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace packmerger::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// At most 128 positions and 8 vectors at once, so that all stay in registers over all cells.
constexpr hn::CappedTag<Height, 32> kHeights;
using Heights = hn::VFromD<decltype(kHeights)>;
constexpr int kLanes = static_cast<int>(hn::MaxLanes(kHeights));
constexpr int kMostVectors = kLanes < 32 ? 8 : 4;
constexpr std::size_t kCellsBetweenLooks = 64;  // at whether all positions are too high by now

static_assert(kLanes - 1 <= kFallReadAhead);

// Writes the first `wanted` of the lanes.
HWY_INLINE void store(Heights vector, Height* to, int wanted) {
  if (wanted >= kLanes) {
    hn::StoreU(vector, kHeights, to);
    return;
  }
  HWY_ALIGN std::array<Height, kLanes> lanes;
  hn::Store(vector, kHeights, lanes.data());
  std::copy_n(lanes.begin(), wanted, to);
}

template <int kVectors>
HWY_INLINE bool all_above(const Heights (&height)[kVectors], Height limit) {
  Heights least = height[0];
  for (int v = 1; v < kVectors; ++v) least = hn::Min(least, height[v]);
  return hn::AllTrue(kHeights, hn::Gt(least, hn::Set(kHeights, limit)));
}

// kVectors of positions; field: of the first position.
template <int kVectors>
HWY_INLINE void fall_together(const Height* field, std::ptrdiff_t stride,
                              std::span<const HeightCell> cells, Height floor, Height give_up_above,
                              Height* heights, int wanted) {
  Heights height[kVectors];
  for (Heights& vector : height) vector = hn::Set(kHeights, floor);
  for (std::size_t next = 0; next < cells.size();) {
    const std::size_t end = std::min(next + kCellsBetweenLooks, cells.size());
    for (; next < end; ++next) {
      const HeightCell cell = cells[next];
      const Height* below = field + cell.y * stride + cell.x;
      const Heights value = hn::Set(kHeights, cell.value);
      for (int v = 0; v < kVectors; ++v)
        height[v] =
            hn::Max(height[v], hn::SaturatedSub(hn::LoadU(kHeights, below + v * kLanes), value));
    }
    if (all_above(height, give_up_above)) break;
  }
  for (int v = 0; v < kVectors && v * kLanes < wanted; ++v)
    store(height[v], heights + v * kLanes, wanted - v * kLanes);
}

// Calls loop(first position, number of vectors) with as many vectors as there are positions for.
template <typename Loop>
HWY_INLINE void in_blocks(int n, const Loop& loop) {
  for (int first = 0; first < n; first += kMostVectors * kLanes) {
    const int vectors = std::min(kMostVectors, (n - first + kLanes - 1) / kLanes);
    const auto run = [&]<int... kLess>(std::integer_sequence<int, kLess...>) HWY_ATTR {
      static_cast<void>((
          (vectors == kLess + 1 && (loop(first, std::integral_constant<int, kLess + 1>{}), true)) ||
          ...));
    };
    run(std::make_integer_sequence<int, kMostVectors>{});
  }
}

void fall(const Height* field_origin, std::ptrdiff_t stride, std::span<const HeightCell> cells,
          int x, int y, Height floor, Height give_up_above, Height* heights, int n) {
  const Height* field = field_origin + y * stride + x;
  in_blocks(n, [&](int first, auto vectors) HWY_ATTR {
    fall_together<vectors()>(field + first, stride, cells, floor, give_up_above, heights + first,
                             n - first);
  });
}

#if HWY_TARGET != HWY_SCALAR
// Two heights that are not negative fit into 16 bits together; even and odd positions are then
// counted in 32 bits each, which needs no lanes to change their places.
constexpr hn::RebindToUnsigned<decltype(kHeights)> kPairs;
constexpr hn::RepartitionToWide<decltype(kPairs)> kSums;
using Sums = hn::VFromD<decltype(kSums)>;

template <int kVectors>
HWY_INLINE void sum_together(const Height* field, std::ptrdiff_t stride,
                             std::span<const HeightCell> cells, std::int32_t* sums, int wanted) {
  const auto above_zero = [&](const HeightCell& cell, int v) HWY_ATTR {
    const Height* below = field + cell.y * stride + cell.x;
    return hn::BitCast(kPairs,
                       hn::Max(hn::LoadU(kHeights, below + v * kLanes), hn::Zero(kHeights)));
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
    for (int i = 0; i < std::min(kLanes, wanted - v * kLanes); ++i)
      sums[v * kLanes + i] =
          static_cast<std::int32_t>(lanes[static_cast<std::size_t>(i / 2 + i % 2 * (kLanes / 2))]);
  }
}

void sum_field(const Height* field_origin, std::ptrdiff_t stride, std::span<const HeightCell> cells,
               int x, int y, std::int32_t* sums, int n) {
  const Height* field = field_origin + y * stride + x;
  in_blocks(n, [&](int first, auto vectors) HWY_ATTR {
    sum_together<vectors()>(field + first, stride, cells, sums + first, n - first);
  });
}

#else

void sum_field(const Height* field_origin, std::ptrdiff_t stride, std::span<const HeightCell> cells,
               int x, int y, std::int32_t* sums, int n) {
  std::fill_n(sums, n, 0);
  for (const HeightCell& cell : cells) {
    const Height* field = field_origin + (y + cell.y) * stride + x + cell.x;
    for (int i = 0; i < n; ++i) sums[i] += std::max<Height>(0, field[i]);
  }
}

#endif

}  // namespace packmerger::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace packmerger {

HWY_EXPORT(fall);
HWY_EXPORT(sum_field);

void fall(const Height* field_origin, std::ptrdiff_t stride, std::span<const HeightCell> cells,
          int x, int y, Height floor, Height give_up_above, Height* heights, int n) {
  HWY_DYNAMIC_DISPATCH(fall)
  (field_origin, stride, cells, x, y, floor, give_up_above, heights, n);
}

void sum_field(const Height* field_origin, std::ptrdiff_t stride, std::span<const HeightCell> cells,
               int x, int y, std::int32_t* sums, int n) {
  HWY_DYNAMIC_DISPATCH(sum_field)(field_origin, stride, cells, x, y, sums, n);
}

}  // namespace packmerger
#endif  // HWY_ONCE
