#include "pack/kernel.h"

#include <algorithm>
#include <array>

namespace packmerger {
namespace {

constexpr std::size_t kCellsBetweenLooks = 48;  // at whether all positions are too high by now

// N positions at once: few enough for their heights to stay in registers over all cells.
template <std::size_t N>
void fall_together(const CellField& upper, const std::vector<MapCell>& reach, int x, int y,
                   float floor, float give_up_above, std::array<float, N>& result) {
  std::array<float, N> height;
  height.fill(floor);
  std::size_t next = 0;
  while (next < reach.size()) {
    const std::size_t end = std::min(next + kCellsBetweenLooks, reach.size());
    for (; next < end; ++next) {
      const MapCell cell = reach[next];
      const float* field = upper.row(x + cell.x, y + cell.y);
      for (std::size_t i = 0; i < N; ++i) {
        const float rest = field[i] - cell.value;
        height[i] = height[i] > rest ? height[i] : rest;
      }
    }
    if (*std::min_element(height.begin(), height.end()) > give_up_above) break;
  }
  result = height;
}

template <std::size_t N>
void sum_together(const CellField& surface, const std::vector<MapCell>& cells, bool weighted, int x,
                  int y, std::array<float, N>& result) {
  std::array<float, N> sum{};
  for (const MapCell& cell : cells) {
    const float* field = surface.row(x + cell.x, y + cell.y);
    const float weight = weighted ? cell.value : 1.0F;
    for (std::size_t i = 0; i < N; ++i) sum[i] += weight * field[i];
  }
  result = sum;
}

// Calls loop(first position, array) for 16 positions at a time, or 8 where no more are left.
template <typename Loop>
void in_groups(std::vector<float>& results, const Loop& loop) {
  for (std::size_t done = 0; done < results.size();) {
    const std::size_t left = results.size() - done;
    const auto run = [&](auto group) {
      loop(static_cast<int>(done), group);
      const std::size_t wanted = std::min(left, group.size());
      std::copy_n(group.begin(), wanted, results.begin() + static_cast<std::ptrdiff_t>(done));
      done += wanted;
    };
    if (left > 8)
      run(std::array<float, 16>{});
    else
      run(std::array<float, 8>{});
  }
}

}  // namespace

void fall(const CellField& upper, const std::vector<MapCell>& reach, int x, int y, float floor,
          float give_up_above, std::vector<float>& heights) {
  in_groups(heights, [&](int first, auto& group) {
    fall_together(upper, reach, x + first, y, floor, give_up_above, group);
  });
}

void sum_field(const CellField& surface, const std::vector<MapCell>& cells, bool weighted, int x,
               int y, std::vector<float>& sums) {
  in_groups(sums, [&](int first, auto& group) {
    sum_together(surface, cells, weighted, x + first, y, group);
  });
}

}  // namespace packmerger
