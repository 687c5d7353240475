// The search for a low layout of parts that may stand anywhere: a limit falls, what sticks out of
// it is taken out with some others, and put back below it (ruin and recreate: Schrimpf et al.,
// 2000; a limit that falls instead of a height that is weighed: Umetani et al., 2009).
#pragma once

#include <functional>
#include <vector>

#include "base/random.h"
#include "model/plate.h"
#include "pack/free/lowest_place.h"

namespace packmerger {

// What the search is about. Parts that are copies of one another share their shape.
struct FreeParts {
  std::vector<const Shape*> shapes;  // by part
  // That every part is tried in, beside that of the start; few parts also in these after the
  // start's.
  std::vector<Mat3> rotations;
};

class LimitSearch {
 public:
  // plate: its walls within the base. start: poses of the shapes' frames, a layout that lies within
  // the base, and what its height is; parts that the lattice finds too close are put back
  // elsewhere. shapes must outlive it.
  LimitSearch(FreeParts parts, const Vec2& base_mm, const Plate& plate, double apart_mm,
              const std::vector<Pose>& start, double start_height_mm, std::uint64_t seed);

  // Rounds until all parts lie below the limit; false where is_over says so before.
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
  struct Put {
    std::size_t way = 0;  // of the part's shape
    BitPlace place;
  };

  void draw();
  void begin(const std::vector<Pose>& start);
  bool greedy(bool largest_first);
  void put_nearest(const std::vector<Put>& puts, double old_unit_mm);
  void round();
  std::vector<int> neighbours(std::size_t count, const std::vector<char>& taken);
  bool put_back(int part, double noise_mm, double per_column_mm, double per_row_mm, double share);
  void fill(int part);
  void clear(int part);
  const BitPart& drawn(int part, std::size_t way) const;
  double top_mm(int part) const;
  double highest_mm() const;
  Vec3 middle(int part) const;
  Pose pose(int part) const;
  std::vector<int> unplaced() const;

  FreeParts parts_;
  Vec2 base_mm_;
  double apart_mm_;
  Random random_;
  std::vector<const Shape*> different_;      // shapes, each once
  std::vector<std::size_t> shape_of_;        // by part: index into different_
  std::vector<std::vector<Mat3>> ways_;      // by shape: without twins
  std::vector<std::vector<BitPart>> drawn_;  // by shape and way
  BitGrid grid_;
  HeightBits bare_;  // nothing but walls
  HeightBits tray_;
  double limit_mm_;  // with the room that parts keep from one another, as all heights here
  double drawn_for_mm_;
  double shrink_;             // the next limit, of the height
  std::size_t rounds_ = 0;    // since the limit was set
  std::vector<Put> puts_;     // by part
  std::vector<char> placed_;  // by part
  std::vector<double> size_;  // by part: large ones are put back first
  std::vector<double> weight_;
};

}  // namespace packmerger
