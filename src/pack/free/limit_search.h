// The search for a low layout of parts that may stand anywhere: a limit falls, what sticks out of
// it is taken out with some others, and put back below it (ruin and recreate: Schrimpf et al.,
// 2000; a limit that falls instead of a height that is weighed: Umetani et al., 2009).
#pragma once

#include <functional>
#include <vector>

#include "base/random.h"
#include "pack/lattice/lattice_layout.h"

namespace packmerger {

class LimitSearch {
 public:
  // plate: its walls within the base. start: poses of the shapes' frames, a layout that lies within
  // the base, and what its height is; parts that the lattice finds too close are put back
  // elsewhere. shapes and effort must outlive it. is_over says that time is up for good, to any
  // thread; it may throw to cancel.
  LimitSearch(FreeParts parts, const Vec2& base_mm, const Plate& plate, double apart_mm,
              const std::vector<Pose>& start, double start_height_mm, std::uint64_t seed,
              std::function<bool()> is_over, Effort& effort);

  // Rounds until all parts lie below the limit; false where is_over, this one or the search's own,
  // says so before.
  bool next(const std::function<bool()>& is_over);

  // Of a layout that next() found: not quite apart, but nearly.
  double height_mm() const;
  std::vector<Pose> poses() const;

  // Goes on below the height of the layout that was found: a little, or further while layouts are
  // found at once.
  void lower_limit();
  // Goes on at the same limit, with some parts to be put elsewhere.
  void take_out(const std::vector<int>& parts);

 private:
  void begin(const std::vector<Pose>& start);
  bool greedy(bool largest_first);
  void round();
  std::vector<int> neighbours(std::size_t count, const std::vector<char>& taken);
  bool put_back(int part, double noise_mm, double per_column_mm, double per_row_mm, double share);

  Vec2 base_mm_;
  double apart_mm_;
  Random random_;
  std::function<bool()> is_over_;
  Effort& effort_;
  LatticeLayout layout_;
  bool is_drawn_;
  double limit_mm_;  // with the room that parts keep from one another, as all heights here
  double drawn_for_mm_;
  double shrink_;             // the next limit, of the height
  std::size_t rounds_ = 0;    // since the limit was set
  std::vector<double> size_;  // by part: large ones are put back first
  std::vector<double> weight_;
};

}  // namespace packmerger
