// The packer of the paper's section 6.1 to the letter, simple and slow: what speed and quality of
// src/pack are measured against. Depth maps of both sides from OSMesa's z-buffer, every rotation
// step at every position of the grid, drop from above, cost (1). One tray, one thread.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "bench/order.h"
#include "fixtures/z_buffer.h"
#include "model/packing.h"
#include "pack/maps/merge.h"

namespace packmerger::bench {

// A height in whole units; ReferencePacker says how long one is.
using Height = std::int16_t;

// A part in one rotation, on a grid that starts at the corner of its box. Rows of `width` cells;
// heights above the lowest point of the part.
struct ReferenceMaps {
  Mat3 rotation = Mat3::Identity();
  Box3 box;  // mm, from the grid's corner and the lowest point on, rounded up to whole units
  int width = 0;
  int height = 0;
  std::vector<Height> bottom;       // kNothing where the ray misses
  std::vector<Height> top;          // kNothing where the ray misses
  std::vector<std::uint8_t> hangs;  // 1 where the lowest facet needs support
  int growth = 0;                   // cells by which `reach` stands out on each side
  std::vector<Height> reach;        // bottom grown by the gap in every direction
};

struct ReferencePlacement {
  int part = 0;
  int rotation = 0;
  int x = 0;  // cells
  int y = 0;
  int z = 0;        // units
  int top = 0;      // units, of the part there
  int waste = 0;    // units, summed over the cells
  double cost = 0;  // of the tray with the part on it
};

struct ReferencePacking {
  std::vector<ReferencePlacement> placed;  // in order
  double cost = 0;                         // infinite where a part found no place
};

// Which of several places of equal cost is taken; the paper does not say. Both go on with the least
// z, y, x and rotation.
enum class Ties {
  kLowestPlace,  // the plain rule: what the part stands on is lowest
  kLowestTop,    // the packer's: the part's own top is lowest
};

class ReferencePacker {
 public:
  static constexpr Height kNothing = -32768;

  // Grid, rotation step, gap, support angle and cost are the problem's; it must outlive the packer.
  explicit ReferencePacker(const PackProblem& problem, Ties ties = Ties::kLowestPlace);

  // Draws the maps of a part in every rotation that fits the build volume.
  std::vector<ReferenceMaps> draw(const ItemSet& items);

  ReferencePacking pack(const std::vector<std::vector<ReferenceMaps>>& parts,
                        const std::vector<double>& volumes_mm3, const Order& order);

  double unit_mm() const { return unit_mm_; }
  // Cells of parts compared with cells of the height field so far.
  double cells() const { return cells_; }

 private:
  struct Tray;

  Height units(double mm) const;
  ReferenceMaps draw(const std::vector<Mesh>& surfaces, const Mat3& rotation);
  std::optional<ReferencePlacement> best(const Tray& tray, const std::vector<ReferenceMaps>& part,
                                         double volume_mm3);
  double waste_mm3(const ReferencePlacement& place) const;
  // The tray's box with the part in it, and the tray's figures.
  Box3 contents_with(const Tray& tray, const ReferenceMaps& maps,
                     const ReferencePlacement& place) const;
  TrayMeasure measure(const Tray& tray, const ReferenceMaps& maps, double volume_mm3,
                      const ReferencePlacement& place) const;

  const PackProblem& problem_;
  Ties ties_;
  double unit_mm_;
  int columns_;  // of the tray
  int rows_;
  std::vector<Mat3> rotations_;
  DepthRenderer renderer_;
  double cells_ = 0;
};

}  // namespace packmerger::bench
