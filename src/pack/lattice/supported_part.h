// A part on the lattice of height bits, and the matter that stands over each cell's centre: what
// tells how much support it adds to a tray or takes from it.
#pragma once

#include <vector>

#include "pack/lattice/height_bits.h"

namespace packmerger {

// Matter over a cell's centre.
struct MatterSpan {
  float low = 0;  // mm
  float high = 0;
  bool hangs = false;  // its lower side needs support
};

// In one rotation. Heights are the tray's where the part stands at the place (0, 0, 0).
struct SupportedPart {
  BitPart bits;
  Box3 box;                       // tray coordinates, mm
  double matter_mm3 = 0;          // as the lines through the cells see it
  std::vector<MatterSpan> spans;  // by cell, from the lowest up
  std::vector<int> first;         // by cell, rows of bits.width, and one more: into spans

  // What decides the support that the part adds where nothing stands over it: of every kBlock by
  // kBlock cells how many bear such a height, and its mean. Where every lower side needs support it
  // is the upper side, and matter counts as support does, so that what is below it is had for
  // nothing; elsewhere it is the lowest side, where that needs support.
  static constexpr int kBlock = 4;
  static constexpr int kBlocksRead = 8;  // at once: the stride is a multiple of it
  int block_rows = 0;
  int block_stride = 0;
  std::vector<float> block_cells;
  std::vector<float> block_height;  // mm
  double own_mm3 = 0;               // of support, whatever lies below
};

// apart_mm as for bit_part(); support_angle: radians.
SupportedPart supported_part(const Shape& shape, const Mat3& rotation, const BitGrid& grid,
                             double apart_mm, double support_angle);

}  // namespace packmerger
