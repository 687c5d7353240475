#include "pack/fall.h"

#include <algorithm>

namespace packmerger {

void fall(const Height* field, std::ptrdiff_t stride, std::span<const HeightCell> cells, int x,
          int y, Height floor, Height, Height* heights, int n) {
  std::fill_n(heights, n, floor);
  for (const HeightCell& c : cells) {
    const Height* row = field + (y + c.y) * stride + x + c.x;
    for (int i = 0; i < n; ++i)
      heights[i] = std::max(heights[i], static_cast<Height>(row[i] - c.value));
  }
}

void sum_field(const Height* field, std::ptrdiff_t stride, std::span<const HeightCell> cells, int x,
               int y, std::int32_t* sums, int n) {
  std::fill_n(sums, n, 0);
  for (const HeightCell& c : cells) {
    const Height* row = field + (y + c.y) * stride + x + c.x;
    for (int i = 0; i < n; ++i) sums[i] += row[i];
  }
}

}  // namespace packmerger
