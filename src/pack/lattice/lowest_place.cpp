#include "pack/lattice/lowest_place.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "base/simd_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pack/lattice/lowest_place.cpp"
#include <hwy/foreach_target.h>  // includes this file once for each target

#include "pack/lattice/taken_heights-inl.h"

HWY_BEFORE_NAMESPACE();
namespace packmerger::HWY_NAMESPACE {

bool lower_place(const HeightBits& tray, const BitPart& part, const PlaceRating& rating,
                 RatedPlace& best) {
  if (part.runs.empty()) return false;
  const double highest = std::floor((rating.limit_mm - part.height_mm) / rating.unit_mm + 1e-6);
  if (highest < 0) return false;
  const int columns = tray.columns() - part.width + 1;
  const int rows = tray.rows() - part.depth + 1;
  bool found = false;
  std::size_t looked = 0;
  for (int y = 0; y < rows; ++y)
    for (int x = 0; x < columns; x += kPositions) {
      const double aside = part.height_mm + rating.malus_mm + rating.per_row_mm * y;
      const double least =
          aside + std::min(rating.per_column_mm * x, rating.per_column_mm * (x + kPositions - 1));
      // Heights that could not be better count as taken.
      const double pays = std::floor((best.rating_mm - least) / rating.unit_mm + 1e-9);
      const double top = std::min(highest, pays);
      if (!(top >= 0)) continue;
      const std::uint64_t above =
          top >= kHeights - 1 ? 0 : ~std::uint64_t{0} << (static_cast<int>(top) + 1);
      std::array<std::uint64_t, kPositions> taken;
      taken.fill(above);
      for (int k = columns - x; k < kPositions; ++k)
        taken[static_cast<std::size_t>(k)] = ~std::uint64_t{0};
      const bool is_free = take(tray, part, y * tray.stride() + x, taken, looked);
      best.looked += looked;
      if (!is_free) continue;
      for (int k = 0; k < kPositions; ++k) {
        const std::uint64_t free = ~taken[static_cast<std::size_t>(k)];
        if (free == 0) continue;
        const int z = std::countr_zero(free);
        const double rated = aside + z * rating.unit_mm + rating.per_column_mm * (x + k);
        if (rated >= best.rating_mm) continue;
        best.place = {x + k, y, z};
        best.rating_mm = rated;
        found = true;
      }
    }
  return found;
}

}  // namespace packmerger::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace packmerger {

HWY_EXPORT(lower_place);

bool lower_place(const HeightBits& tray, const BitPart& part, const PlaceRating& rating,
                 RatedPlace& best) {
  return HWY_DYNAMIC_DISPATCH(lower_place)(tray, part, rating, best);
}

}  // namespace packmerger
#endif  // HWY_ONCE
