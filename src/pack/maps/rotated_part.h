// A part in one rotation, laid out for the placement kernel.
#pragma once

#include <vector>

#include "base/geometry.h"
#include "pack/maps/depth_map.h"
#include "pack/maps/grid.h"
#include "pack/maps/plate_mask.h"

namespace packmerger {

// The part's own frame: cell (i, j) of the grid is [i·grid, (i+1)·grid] × [j·grid, (j+1)·grid],
// z = 0 its lowest point. A position (x, y, z) adds x and y whole cells and z units.
struct RotatedPart {
  Mat3 rotation = Mat3::Identity();
  Vec3 shift = Vec3::Zero();  // own frame = rotation * model coordinates + shift, mm
  Box3 box;                   // in the own frame, mm, rounded outwards to units; x, y in [0, grid)
  Height rise = 0;            // height of the box, units
  std::vector<HeightCell> reach;  // the lower side of matter, grown by the gap in every direction
  std::vector<HeightCell> top;    // its upper side
  std::vector<HeightCell> roof;   // the highest matter at the cell's centre
  std::vector<HeightCell> hang;   // the lowest matter there, where it needs support
  std::int64_t hang_sum = 0;      // of the values of `hang`
  double inside_support_mm3 = 0;  // between the part's own surfaces
  BarredPositions barred;         // by the plate's walls
};

struct Grid {
  double cell_mm = 1;
  double unit_mm = 1.0 / 64;
  double gap_mm = 1;
  // What `reach` and `top` hold. Bounds of whole cells, rounded outwards: parts keep their gap
  // wherever they are put. Or samples (draw_sampled_maps): a wall takes the room it takes on
  // average, so a search on coarse cells sees what a finer grid will make of its layout.
  bool bounds = true;

  int growth() const { return growth_cells(gap_mm, cell_mm); }
};

// The cells in the order in which a fall (fall.h) should meet them: those first that decide most,
// the lowest of every few, the lower ones before the higher ones; the others behind them.
std::vector<HeightCell> decisive_first(const std::vector<HeightCell>& cells);

// rotation, shift, inside support and barred positions are the caller's.
RotatedPart quantised(const DepthMaps& maps, const Grid& grid);

// Without those that look the same to the packer as an earlier one: a symmetry of the part makes
// them equal, or the grid does. Wherever one of them may lie the other may, at the same cost.
std::vector<const RotatedPart*> different(const std::vector<const RotatedPart*>& rotations);

}  // namespace packmerger
