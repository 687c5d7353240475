// The matter over every cell of a tray, and the support that it needs.
#pragma once

#include <vector>

#include "pack/lattice/supported_part.h"

namespace packmerger {

class SupportColumns {
 public:
  explicit SupportColumns(const BitGrid& grid);

  // x, y: cells; z_mm: above the lattice's lowest place.
  void put(const SupportedPart& part, int number, int x, int y, double z_mm);
  void take(const SupportedPart& part, int number, int x, int y);

  // V_s, mm³, and what a part more would add to it, which may be less than nothing: matter that
  // stands in a void takes its support away.
  double support_mm3() const { return support_mm_ * cell_mm2_; }
  double added_mm3(const SupportedPart& part, int x, int y, double z_mm) const;

  // The mean upper side of blocks of cells, one beside the other from a cell on, as of the last
  // call of pool(). Rows of pooled_stride().
  void pool();
  const float* pooled(int x, int y) const {
    return pooled_[static_cast<std::size_t>(x % SupportedPart::kBlock)].data() +
           y * pooled_stride_ + x / SupportedPart::kBlock;
  }
  std::ptrdiff_t pooled_stride() const { return pooled_stride_; }
  double cell_mm2() const { return cell_mm2_; }

 private:
  struct Standing {
    MatterSpan span;  // tray coordinates
    int number = 0;   // of the part
  };
  using Column = std::vector<Standing>;  // from the lowest up

  static double voids_mm(const Column& column);
  template <typename Visit>
  void over_cells(const SupportedPart& part, int x, int y, const Visit& visit) const;
  void entered(const SupportedPart& part, std::size_t cell, int number, float z_mm,
               Column& column) const;

  int columns_;
  int rows_;
  double cell_mm2_;
  double support_mm_ = 0;  // summed over the cells
  std::vector<Column> cells_;
  std::ptrdiff_t pooled_stride_;
  std::vector<std::vector<float>> pooled_;  // by the first cell's remainder
};

}  // namespace packmerger
