// The tray's height field (paper, section 6.1): the upper horizon of what lies on it, on the fine
// grid of the answer and pooled into the coarse grid that positions are first looked for on.
#pragma once

#include <vector>

#include "model/packing.h"
#include "pack/part.h"

namespace packmerger {

// One array of cell values with a border of empty cells all round, so that no reader tests limits.
class CellField {
 public:
  CellField(int width, int height, int border, float empty);

  int width() const { return width_; }
  int height() const { return height_; }

  // Cells (x, y), (x+1, y), … ; x and y from -border.
  const float* row(int x, int y) const { return &values_[index(x, y)]; }
  float& at(int x, int y) { return values_[index(x, y)]; }

 private:
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y + border_) * static_cast<std::size_t>(stride_) +
           static_cast<std::size_t>(x + border_);
  }
  int width_;
  int height_;
  int border_;
  int stride_;
  std::vector<float> values_;
};

// What `upper` holds over the bare plate: no part needs a gap to the plate, so it never decides a
// height.
inline constexpr float kBarePlate = -1e9F;

struct HeightField {
  // coarse: fine cells on each side of a block; growth: PartMaker::growth().
  HeightField(const Vec3& build_mm, double grid_mm, int coarse, int growth);

  // Enters a part at a position (cells, cells, mm).
  void add(const RotatedPart& part, int x, int y, double z);

  int coarse;
  CellField upper;           // upper bound of matter, or kBarePlate
  CellField surface;         // the horizon at cell centres, 0 on the plate
  CellField coarse_upper;    // maximum of `upper` in the block
  CellField coarse_surface;  // mean of `surface` in the block
};

// A tray while it is filled.
struct TrayState {
  TrayState(const Vec3& build_mm, double grid_mm, int coarse, int growth)
      : field(build_mm, grid_mm, coarse, growth) {}

  TrayMeasure measure() const;

  HeightField field;
  Box3 contents;  // mm, tray coordinates; empty at first
  double support_mm3 = 0;
  double material_mm3 = 0;
  int parts = 0;
  bool closed = false;  // takes no more parts: its one part fits only off the grid
};

}  // namespace packmerger
