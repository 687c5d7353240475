// A tray while it is filled: its height field (paper, section 6.1), the upper horizon of what lies
// on it, and its figures so far.
#pragma once

#include <vector>

#include "model/packing.h"
#include "pack/maps/rotated_part.h"

namespace packmerger {

// Cells over the build volume with a border of empty ones all round and room behind the last, so
// that no reader tests limits.
class HeightField {
 public:
  HeightField(int width, int height, int border, Height empty);

  std::ptrdiff_t stride() const { return stride_; }
  int rows() const { return rows_; }  // with the border
  int border() const { return border_; }
  const Height* origin() const { return &values_[index(0, 0)]; }
  Height& at(int x, int y) { return values_[index(x, y)]; }

 private:
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>((y + border_) * stride_ + x + border_);
  }
  int border_;
  int stride_;
  int rows_;
  std::vector<Height> values_;
};

// What stays the same for all trays of a packing.
struct TraySpec {
  Vec3 build_mm = Vec3::Zero();
  Grid grid;
  const Cost* cost = nullptr;

  int columns() const { return cells_along(build_mm.x(), grid.cell_mm); }
  int rows() const { return cells_along(build_mm.y(), grid.cell_mm); }
  Height ceiling() const { return ceiling_units(build_mm.z(), grid.unit_mm); }
};

struct TrayState {
  explicit TrayState(const TraySpec& spec);

  // Enters a part at a position; support_mm3: what it adds.
  void put(const RotatedPart& part, int x, int y, Height z, double support_mm3, double volume_mm3,
           const TraySpec& spec);

  TrayMeasure measure() const;

  HeightField upper;    // upper bound of matter, or kBarePlate
  HeightField surface;  // the horizon at cell centres, 0 on the plate
  Box3 contents;        // mm, tray coordinates; empty at first
  double support_mm3 = 0;
  double material_mm3 = 0;
  int parts = 0;
};

}  // namespace packmerger
