// A plate's walls on a grid: the cells that they take, and the positions at which a part would
// stand over one of them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "model/plate.h"
#include "pack/maps/grid.h"

namespace packmerger {

// Of one part in one rotation. Empty where all positions within the tray are free.
class BarredPositions {
 public:
  BarredPositions() = default;
  BarredPositions(const Range& xs, const Range& ys)
      : xs_(xs),
        ys_(ys),
        barred_(static_cast<std::size_t>(xs.count()) * static_cast<std::size_t>(ys.count())) {}

  bool empty() const { return barred_.empty(); }
  // x, y: within the ranges given, which are those within the tray.
  bool at(int x, int y) const { return barred_[index(x, y)] != 0; }
  std::uint8_t& at(int x, int y) { return barred_[index(x, y)]; }

 private:
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y - ys_.first) * static_cast<std::size_t>(xs_.count()) +
           static_cast<std::size_t>(x - xs_.first);
  }

  Range xs_;
  Range ys_;
  std::vector<std::uint8_t> barred_;
};

// A cell of a part's footprint.
struct FootCell {
  int x = 0;
  int y = 0;
};

class PlateMask {
 public:
  PlateMask() = default;  // no walls
  // bounds: a cell is taken where any of it lies over a wall, so that what stands on free cells
  // alone stands clear; otherwise where its centre does.
  PlateMask(const Plate& plate, const Vec3& build_mm, double cell_mm, bool bounds);

  bool empty() const { return rows_.empty(); }

  // box: the part's, in the frame of its footprint.
  BarredPositions barred(std::vector<FootCell> footprint, const Box3& box) const;

 private:
  using Runs = std::vector<Range>;

  Vec3 build_mm_ = Vec3::Zero();
  double cell_mm_ = 1;
  std::vector<Runs> rows_;  // the cells taken
};

// The cells of anything that has an x and a y, each at least once.
template <typename Cell>
std::vector<FootCell> footprint_of(const std::vector<Cell>& cells) {
  std::vector<FootCell> footprint;
  footprint.reserve(cells.size());
  for (const Cell& cell : cells)
    if (footprint.empty() || footprint.back().x != cell.x || footprint.back().y != cell.y)
      footprint.push_back({cell.x, cell.y});
  return footprint;
}

}  // namespace packmerger
