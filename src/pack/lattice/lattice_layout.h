// Parts on a lattice of height bits: where each of them stands, in which of its ways up, and what
// they look like there.
#pragma once

#include <functional>
#include <vector>

#include "base/effort.h"
#include "model/plate.h"
#include "pack/lattice/lowest_place.h"

namespace packmerger {

// What the search is about. Parts that are copies of one another share their shape.
struct FreeParts {
  std::vector<const Shape*> shapes;  // by part
  // That every part is tried in, beside that of the start; few parts also in these after the
  // start's. A shape of many copies takes but a few of their starts.
  std::vector<Mat3> rotations;
};

// On the lattice all heights hold the room that parts keep from one another.
class LatticeLayout {
 public:
  struct Put {
    std::size_t way = 0;  // of the part's shape
    BitPlace place;
  };

  // plate: its walls within the base. start: poses of the shapes' frames. shapes must outlive it.
  // Nothing is placed yet.
  LatticeLayout(FreeParts parts, const Vec2& base_mm, const Plate& plate, double apart_mm,
                const std::vector<Pose>& start);

  // Draws the parts for a limit; none of them is placed then. False where is_over, which any thread
  // asks, said so before all were drawn: there is nothing to be done with the layout.
  bool draw(double limit_mm, const std::function<bool()>& is_over, Effort& effort);

  std::size_t size() const { return puts_.size(); }
  const BitGrid& grid() const { return grid_; }
  const Shape& shape(int part) const { return *parts_.shapes[static_cast<std::size_t>(part)]; }
  std::size_t ways(int part) const { return drawn_[shape_of(part)].size(); }
  const BitPart& drawn(int part, std::size_t way) const { return drawn_[shape_of(part)][way]; }

  bool is_placed(int part) const { return placed_[static_cast<std::size_t>(part)] != 0; }
  std::vector<int> unplaced() const;

  // Puts into `best` the place of the part in one of its ways up, as lower_place does.
  bool lower(int part, std::size_t way, const PlaceRating& rating, RatedPlace& best) const {
    return lower_place(tray_, drawn(part, way), rating, best);
  }
  void put(int part, const Put& put);
  void take(int part);
  void take_all();

  // Where each of them stands or stood last.
  const std::vector<Put>& puts() const { return puts_; }
  // Puts all where they were, or nearly as high, and below the limit; what has no room there stays
  // out. old_unit_mm: of the heights in `puts`.
  void put_nearest(const std::vector<Put>& puts, double old_unit_mm, double limit_mm);
  // Where the layout of these poses comes closest to the lattice.
  std::vector<Put> nearest(const std::vector<Pose>& poses) const;

  double top_mm(int part) const;
  double highest_mm() const;
  Pose pose(int part) const;  // of the shape's frame, on the tray

 private:
  std::size_t shape_of(int part) const { return shape_of_[static_cast<std::size_t>(part)]; }
  void add_ways(std::size_t shape, const Mat3& start);

  FreeParts parts_;
  double apart_mm_;
  Vec2 base_mm_;
  std::vector<const Shape*> different_;      // shapes, each once
  std::vector<std::size_t> shape_of_;        // by part: index into different_
  std::vector<std::vector<Mat3>> ways_;      // by shape: without twins
  std::vector<std::vector<BitPart>> drawn_;  // by shape and way
  BitGrid grid_;
  HeightBits bare_;  // nothing but walls
  HeightBits tray_;
  std::vector<Put> puts_;     // by part
  std::vector<char> placed_;  // by part
};

}  // namespace packmerger
