// The search for a cheap layout of parts that may stand anywhere on a lattice: some are taken out,
// and put back where the tray becomes cheapest (ruin and recreate: Schrimpf et al., 2000).
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <vector>

#include "base/random.h"
#include "model/packing.h"
#include "pack/lattice/cheapest_place.h"

namespace packmerger {

// Parts that are copies of one another share their shape and the ways it is tried in.
struct CostedParts {
  std::vector<const Shape*> shapes;     // by part
  std::vector<std::vector<Mat3>> ways;  // by part, the best alone first
};

class CostSearch {
 public:
  // start: poses of the shapes' frames, a layout that lies within the tray; parts that the lattice
  // finds too close are put elsewhere. limit_mm: no layout is higher. All must outlive it; is_over
  // says that time is up, and may throw to cancel.
  CostSearch(const PackProblem& problem, CostedParts parts, const std::vector<Pose>& start,
             double limit_mm, double apart_mm, std::uint64_t seed, std::function<bool()> is_over);

  // Rounds until so many, one after the other, found nothing cheaper, or time is up. The same on
  // any number of threads.
  void run(std::size_t patience);

  // Of the cheapest layout so far: not quite apart, but nearly. Infinite while some part found no
  // place.
  double cost() const { return lowest_; }
  std::vector<Pose> poses() const;

 private:
  struct Put {
    std::size_t way = 0;
    BitPlace place;
  };
  // What a layout is worth: fewer parts without a place first.
  struct Worth {
    std::size_t left_out = 0;
    double cost = 0;
  };

  void begin(const std::vector<Pose>& start);
  bool put_near(std::size_t part, const Pose& start);
  bool round();
  std::vector<std::size_t> chosen();
  bool put_back(std::size_t part, double noise);
  std::vector<std::size_t> some_ways(std::size_t part);
  PlaceCosts place_costs(const SupportedPart& part) const;
  void draw(std::size_t part, const std::vector<std::size_t>& ways);
  const SupportedPart& drawn(std::size_t part, std::size_t way) const;
  void enter(std::size_t part, const Put& put);
  void take(std::size_t part);
  void take_over(const std::vector<Put>& puts, const std::vector<char>& placed);
  void note_contents();
  Vec3 at(const BitPlace& place) const;
  Pose pose(std::size_t part, const Put& put) const;
  double cost_with(const Box3& box, double support_mm3, double material_mm3, int parts) const;
  Worth worth() const;

  const PackProblem& problem_;
  CostedParts parts_;
  double apart_mm_;
  double limit_mm_;  // with the room that parts keep from one another
  Random random_;
  std::function<bool()> is_over_;
  std::vector<std::size_t> shape_of_;  // by part: the first with its shape
  BitGrid grid_;
  HeightBits tray_;
  SupportColumns columns_;
  std::vector<std::map<std::size_t, std::unique_ptr<SupportedPart>>> drawn_;  // by shape, then way
  std::vector<Put> puts_;
  std::vector<char> placed_;
  Box3 contents_;  // of the placed parts, tray coordinates
  double material_mm3_ = 0;
  int standing_ = 0;
  Worth here_;
  double lowest_ = 0;
  std::vector<Put> best_;
};

}  // namespace packmerger
