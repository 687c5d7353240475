// Depth maps of one item in one rotation (paper, section 7, which reads both sides from a z-buffer;
// here they bound the surface exactly), and the maps of merged parts, which are made of their
// members' maps without drawing anything.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "model/mesh.h"

namespace packmerger {

// All maps of a model in one rotation share one grid: cell (i, j) is the square
// [i·grid, (i+1)·grid] × [j·grid, (j+1)·grid] of the rotated frame. Arrays hold the cells
// x0..x0+width-1, y0..y0+height-1, x fastest; heights in mm.
struct DepthMaps {
  int x0 = 0;
  int y0 = 0;
  int width = 0;
  int height = 0;
  Box3 box;  // exact, of the rotated surface, mm
  // The surface's least and greatest height over the whole closed cell.
  std::vector<float> low;  // kNothingAbove where the cell holds nothing
  std::vector<float> top;  // kNothingBelow
  // Samples at the cell's centre: a centre exactly on an edge belongs to one of the facets there.
  std::vector<float> bottom;        // kNothingAbove where the line misses
  std::vector<float> roof;          // kNothingBelow
  std::vector<std::uint8_t> hangs;  // 1 where the facet seen from below needs support
};

// surface: closed, normals outward, in the rotated frame, mm. Every value is that of the exact
// triangles, but for rounding to float and for what reaches less than 1e-7 cells into a cell.
// Orthographic projection along z. A facet hangs when its normal points down by more than
// support_angle (radians) below the horizontal.
DepthMaps draw_depth_maps(const Mesh& surface, double grid_mm, double support_angle);

// The samples at the centres alone, a few times faster: nothing is in `low` and `top`.
DepthMaps draw_centre_maps(const Mesh& surface, double grid_mm, double support_angle);

// The surface as a search on coarse cells sees it: `low` and `top` are the least and greatest of
// samples at a quarter of a cell to both sides of the centre, so that matter takes half a cell more
// room than it has, which on average is room for a gap of that width; the samples are taken a
// quarter of a cell off the centre.
DepthMaps draw_sampled_maps(const Mesh& surface, double grid_mm, double support_angle);

// The upper envelope alone: the surface's greatest height at the centres of the cells. Arrays as
// above.
struct RoofMap {
  int x0 = 0;
  int y0 = 0;
  int width = 0;
  int height = 0;
  Box3 box;                 // exact, mm
  std::vector<float> roof;  // kNothingBelow where the line misses
};

// Empty maps, or an empty roof, over the cells and the box of all members together.
template <typename Map>
Map frame_of(const std::vector<const Map*>& members) {
  Map all;
  int x1 = members.front()->x0;
  int y1 = members.front()->y0;
  all.x0 = x1;
  all.y0 = y1;
  for (const Map* member : members) {
    all.x0 = std::min(all.x0, member->x0);
    all.y0 = std::min(all.y0, member->y0);
    x1 = std::max(x1, member->x0 + member->width);
    y1 = std::max(y1, member->y0 + member->height);
    all.box.extend(member->box);
  }
  all.width = x1 - all.x0;
  all.height = y1 - all.y0;
  return all;
}

// `roof` as draw_centre_maps() has it, in half the time: facets that face down are not drawn.
RoofMap draw_roof(const Mesh& surface, double grid_mm);

// The same item turned by quarters × 90° about z: cells map to cells.
DepthMaps quarter_turned(const DepthMaps& maps, int quarters);

// The maps of several items, of the same rotation and grid, as one.
DepthMaps united_maps(const std::vector<const DepthMaps*>& members);

}  // namespace packmerger
