// A part in one attitude as columns of matter: for every cell of a grid the heights between which
// matter lies, not only the lowest and the highest of them, so that cavities are seen from inside.
#pragma once

#include <vector>

#include "base/geometry.h"
#include "model/mesh.h"
#include "pack/maps/grid.h"
#include "pack/maps/plate_mask.h"

namespace packmerger {

// Matter between two heights in a cell; x and y count cells, heights are in units.
struct SpanCell {
  std::int16_t x = 0;
  std::int16_t y = 0;
  Height low = 0;
  Height high = 0;
  bool hangs = false;  // the facet at `low` needs support
};

struct SolidGrid {
  Vec3 build_mm = Vec3::Zero();
  double cell_mm = 1;
  double unit_mm = 1.0 / 64;
  double gap_mm = 0;         // kept between parts
  double support_angle = 0;  // radians
  // Whether a span bounds all matter over the whole closed cell, rounded outwards, or is what the
  // line through the cell's centre meets. Bounds keep parts apart wherever they are put; samples
  // tell a search on coarse cells what a finer grid will make of its layout.
  bool bounds = true;
  PlateMask mask{};  // of the same cells and the same kind

  int columns() const { return cells_along(build_mm.x(), cell_mm); }
  int rows() const { return cells_along(build_mm.y(), cell_mm); }
  int growth() const { return growth_cells(gap_mm, cell_mm); }
  Height ceiling() const { return ceiling_units(build_mm.z(), unit_mm); }
};

// The lowest and the highest matter over each cell of a rectangle; low > top where there is none.
struct Outline {
  int x0 = 0;
  int y0 = 0;
  int width = 0;
  int height = 0;
  std::vector<Height> low;  // rows of `width`
  std::vector<Height> top;
};

// Cell (i, j) is [i·cell, (i+1)·cell] × [j·cell, (j+1)·cell]. A position (x, y, z) moves the part
// by x and y whole cells and z units.
struct SolidPart {
  Box3 box;                       // exact, mm
  Height rise = 0;                // height of the box's upper side, units, rounded up
  std::vector<SpanCell> matter;   // by y, x and height; spans of a cell do not touch
  std::vector<SpanCell> reach;    // the same grown by the gap in every direction, any order
  std::vector<SpanCell> centres;  // what the lines through the cells' centres meet
  Outline outline;                // of `matter`
  BarredPositions barred;         // by the plate's walls
};

// surfaces: closed, normals outward, mm, in the frame of the position (0, 0, 0), the lowest point
// at z >= 0. They may touch one another along facets, as the segments of one part do.
SolidPart solid_part(const std::vector<Mesh>& surfaces, const SolidGrid& grid);

// The spans of `cells` grown by a ball of the given radius.
std::vector<SpanCell> grown(const std::vector<SpanCell>& cells, const SolidGrid& grid,
                            double radius_mm);

}  // namespace packmerger
