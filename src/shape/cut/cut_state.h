// A division as the search sees it: pieces made of samples. Internal to this folder.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "shape/cut/cut_tree.h"
#include "shape/cut/stand_alone.h"
#include "shape/divide/fit.h"

namespace packmerger {

struct CutPiece {
  PieceShape shape;
  Standing standing;
  bool fits = true;  // the build volume, in some rotation of the packer
  int node = 0;      // of the tree
};

// Cheap to copy but for the labels: pieces are shared.
struct CutState {
  CutTree tree;
  std::vector<std::shared_ptr<const CutPiece>> pieces;
  std::vector<int> piece_of_sample;
  int shut_cavities = 0;  // with one piece all round

  int count() const { return static_cast<int>(pieces.size()); }
  double support_mm3() const;
  double unfit_mm3() const;  // volume of the pieces that fit the build volume in no rotation
  bool is_usable() const { return shut_cavities == 0 && unfit_mm3() == 0; }
};

// What is allowed, and what a division costs.
struct CutRules {
  double support_angle = 0;     // radians
  double least_volume_mm3 = 0;  // of a piece
  double least_glue_mm2 = 0;    // of every joint
  double part_price_mm3 = 0;    // a part costs as much as this much support
  int most_parts = 1;
};

double cost_of(const CutState& state, const CutRules& rules);

// A way to cut one region: step i divides cell `cell` (0: the whole region), what lies above the
// plane becomes cell i + 1.
struct CutStep {
  int cell = 0;
  Plane plane;
};
using CutRecipe = std::vector<CutStep>;

// Tries changes of a division. Holds scratch space: one for each thread.
class CutBench {
 public:
  // build: where the packer's rotations must be able to put every piece.
  CutBench(const MatterSamples& samples, const CutRules& rules, const FitTest& fit)
      : samples_(samples), rules_(rules), fit_(fit), mark_(samples.count(), -1) {}

  // The whole model in one piece.
  CutState whole();

  // The division with the pieces in `group` united and that region cut anew; no steps: they stay
  // united. Fragments go to their largest neighbour within the region. Empty where the rules forbid
  // it: more than most_parts, a piece or a joint too small, more matter that fits the build volume
  // in no rotation than before, more cavities with one piece all round.
  std::optional<CutState> recut(const CutState& state, const std::vector<int>& group,
                                const CutRecipe& recipe, int most_parts);

 private:
  struct Cell {
    std::vector<int> samples;  // ascending
    std::vector<Plane> planes;
    double volume_mm3 = 0;
    int node = 0;
  };
  std::vector<Cell> cut(const Cell& region, const CutRecipe& recipe, CutTree& tree) const;
  std::optional<std::vector<Cell>> connected(std::vector<Cell> cells, CutTree& tree);
  bool glue_is_enough(const CutState& state, const std::vector<Cell>& parts) const;
  bool bounds(const CutState& state, const Cell& part, const Plane& plane) const;
  bool fits_build(const std::vector<int>& list) const;
  int shut_cavities(const CutState& state) const;

  const MatterSamples& samples_;
  const CutRules& rules_;
  const FitTest& fit_;
  std::vector<int> mark_;  // -1 between calls
};

}  // namespace packmerger
