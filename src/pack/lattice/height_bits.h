// A tray as columns of bits: for every cell one word that tells which of 64 heights hold matter.
// Where a part may stand among the others, anywhere and not only from above, is then a few shifts a
// cell for all heights at once.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pack/separate/shape.h"

namespace packmerger {

inline constexpr int kHeights = 64;
// Cells: so far outside of matter a cell's centre may lie where it holds some.
inline constexpr double kMatterReach = 0.45;

// The lattice: cells along x and y, heights along z.
struct BitGrid {
  double cell_mm = 1;
  double unit_mm = 1;
  int columns = 0;
  int rows = 0;
};

// Matter in the heights [low, high) of a column, and the power of two that spans half of it at
// least.
struct BitRun {
  std::int16_t x = 0;
  std::int16_t y = 0;
  std::uint8_t low = 0;
  std::uint8_t high = 0;
  std::uint8_t power = 0;  // of two: the greatest that is no longer than the run

  bool operator==(const BitRun&) const = default;
};

// A part in one rotation.
struct BitPart {
  Mat3 rotation = Mat3::Identity();
  Vec3 origin = Vec3::Zero();  // of the shape's frame, mm, where the part stands at (0, 0, 0)
  int width = 0;               // cells
  int depth = 0;
  double height_mm = 0;
  std::vector<BitRun> runs;  // those first that meet others soonest
};

// apart_mm: what two parts keep from one another; each is grown by half of it. Nearly
// conservative: a cell holds matter where its centre is no further than kMatterReach outside, so
// that what the lattice lets overlap can be separated without room to spare.
// Empty runs where the part is higher than the lattice.
BitPart bit_part(const Shape& shape, const Mat3& rotation, const BitGrid& grid, double apart_mm);

class HeightBits {
 public:
  // Plane k tells of every height whether matter lies in the 2^k heights from there on.
  static constexpr int kPlanes = 6;

  explicit HeightBits(const BitGrid& grid);

  // A wall: no part may stand over the cell at any height, for good.
  void bar(int x, int y);

  // No bit of the part may be set, or all of them.
  void fill(const BitPart& part, int x, int y, int z) { change(part, x, y, z, true); }
  void clear(const BitPart& part, int x, int y, int z) { change(part, x, y, z, false); }

  // The heights at which the part would meet matter, by bit.
  std::uint64_t taken(const BitPart& part, int x, int y) const;

  // Rows of stride() words; eight words may be read from every cell on.
  const std::uint64_t* plane(int power) const {
    return planes_[static_cast<std::size_t>(power)].data();
  }
  std::ptrdiff_t stride() const { return stride_; }
  int columns() const { return columns_; }
  int rows() const { return rows_; }

 private:
  void change(const BitPart& part, int x, int y, int z, bool filled);

  int columns_;
  int rows_;
  std::ptrdiff_t stride_;
  std::array<std::vector<std::uint64_t>, kPlanes> planes_;
};

}  // namespace packmerger
