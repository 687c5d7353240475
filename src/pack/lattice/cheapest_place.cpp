#include "pack/lattice/cheapest_place.h"

#include <algorithm>
#include <array>
#include <bit>

#include "base/simd_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pack/lattice/cheapest_place.cpp"
#include <hwy/foreach_target.h>  // includes this file once for each target

#include "pack/lattice/taken_heights-inl.h"

HWY_BEFORE_NAMESPACE();
namespace packmerger::HWY_NAMESPACE {

constexpr hn::CappedTag<float, SupportedPart::kBlocksRead> kBlocks;
constexpr std::ptrdiff_t kBlockLanes = static_cast<std::ptrdiff_t>(hn::MaxLanes(kBlocks));

// Summed over the part's blocks: by how much it stands above what is there, mm times cells.
HWY_INLINE double above(const SupportColumns& columns, const SupportedPart& part, int x, int y,
                        float z_mm) {
  const auto height = hn::Set(kBlocks, z_mm);
  const auto zero = hn::Zero(kBlocks);
  auto sum = zero;
  const float* there = columns.pooled(x, y);
  const float* own = part.block_height.data();
  const float* cells = part.block_cells.data();
  for (int row = 0; row < part.block_rows; ++row) {
    for (std::ptrdiff_t i = 0; i < part.block_stride; i += kBlockLanes) {
      const auto by =
          hn::Sub(hn::Add(height, hn::LoadU(kBlocks, own + i)), hn::LoadU(kBlocks, there + i));
      sum = hn::Add(sum, hn::Mul(hn::LoadU(kBlocks, cells + i), hn::Max(zero, by)));
    }
    there += SupportedPart::kBlock * columns.pooled_stride();
    own += part.block_stride;
    cells += part.block_stride;
  }
  return static_cast<double>(hn::GetLane(hn::SumOfLanes(kBlocks, sum)));
}

bool cheaper_place(const HeightBits& tray, const SupportColumns& columns, const SupportedPart& part,
                   const PlaceCosts& costs, double unit_mm, CostedPlace& best) {
  const BitPart& bits = part.bits;
  const int heights = std::min(kHeights, static_cast<int>(costs.by_height.size()));
  if (bits.runs.empty() || heights == 0) return false;
  const int places = tray.columns() - bits.width + 1;
  const int rows = tray.rows() - bits.depth + 1;
  const double per_cell_mm = columns.cell_mm2() * costs.per_mm3;
  const double own = part.own_mm3 * costs.per_mm3;
  const std::uint64_t too_high = heights == kHeights ? 0 : ~std::uint64_t{0} << heights;
  bool found = false;
  for (int y = 0; y < rows; ++y) {
    const double row = own + costs.by_row[static_cast<std::size_t>(y)];
    if (row >= best.cost) continue;
    for (int x = 0; x < places; x += kPositions) {
      const int here = std::min(kPositions, places - x);
      const auto column = costs.by_column.begin() + x;
      if (row + *std::min_element(column, column + here) >= best.cost) continue;
      std::array<std::uint64_t, kPositions> taken;
      taken.fill(too_high);
      for (int k = places - x; k < kPositions; ++k)
        taken[static_cast<std::size_t>(k)] = ~std::uint64_t{0};
      std::size_t looked = 0;
      if (!take(tray, bits, y * tray.stride() + x, taken, looked)) continue;
      for (int k = 0; k < here; ++k) {
        const std::uint64_t free = ~taken[static_cast<std::size_t>(k)];
        if (free == 0) continue;
        const int z = std::countr_zero(free);
        const double aside = row + costs.by_column[static_cast<std::size_t>(x + k)] +
                             costs.by_height[static_cast<std::size_t>(z)];
        if (aside >= best.cost) continue;
        const double cost =
            aside + per_cell_mm * above(columns, part, x + k, y, static_cast<float>(z * unit_mm));
        if (cost >= best.cost) continue;
        best = {{x + k, y, z}, cost};
        found = true;
      }
    }
  }
  return found;
}

}  // namespace packmerger::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace packmerger {

HWY_EXPORT(cheaper_place);

bool cheaper_place(const HeightBits& tray, const SupportColumns& columns, const SupportedPart& part,
                   const PlaceCosts& costs, double unit_mm, CostedPlace& best) {
  return HWY_DYNAMIC_DISPATCH(cheaper_place)(tray, columns, part, costs, unit_mm, best);
}

}  // namespace packmerger
#endif  // HWY_ONCE
