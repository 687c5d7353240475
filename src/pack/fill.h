// Filling trays with parts in a given order (paper, section 6.1).
#pragma once

#include <vector>

#include "pack/place.h"

namespace packmerger {

struct Placement {
  int part = 0;  // index into the list of parts
  int tray = 0;
  Spot spot;
  bool off_grid = false;  // pose counts instead of spot
  Pose pose = Pose::Identity();
};

// Trays with what has been put on them so far; copied where a search goes several ways from it.
struct Filling {
  std::vector<TrayState> trays;
  std::vector<Placement> placed;  // in order
};

// Puts parts on trays one by one, each on the first tray that has a place for it.
class Filler {
 public:
  // All three must outlive the filler; parts must fit the build volume.
  Filler(const PackProblem& problem, const PartMaker& maker, const std::vector<Part>& parts);

  // Looks at that many coarse positions closely.
  void set_candidates(int candidates) { rules_.candidates = candidates; }
  // Side by side: nothing on or over anything.
  void set_on_plate_only() { rules_.on_plate_only = true; }

  void add(Filling& filling, int part) const;

  // Sum over the trays of Cost::evaluate.
  double cost(const Filling& filling) const;
  // No filling that starts with this one costs less.
  double bound(const Filling& filling) const;

  Pose pose(const Placement& placement) const;

 private:
  bool add_to(Filling& filling, int tray, int part) const;
  void add_off_grid(Filling& filling, int part) const;

  const PackProblem& problem_;
  const PartMaker& maker_;
  const std::vector<Part>& parts_;
  PlaceRules rules_;
};

}  // namespace packmerger
