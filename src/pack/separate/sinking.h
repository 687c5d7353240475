// Parts sink where that takes support away, all at once, and push one another aside.
#pragma once

#include <functional>
#include <vector>

#include "pack/separate/overlap_energy.h"

namespace packmerger {

struct SinkingRoom {
  Vec3 box_mm;  // the parts are to lie within [0, box_mm]
  double apart_mm = 0;
  double step_mm = 1;        // of the lines along which support is counted
  double support_angle = 0;  // radians
};

// Minimises overlap and support together, the support weighing less and less. Poses are of the
// shapes' own frames; the parts may be a little closer than they should afterwards: Separation
// comes next. is_over says that time is up; it may throw to cancel.
void sink(const std::vector<const Shape*>& shapes, std::vector<Pose>& poses,
          const SinkingRoom& room, const Plate& plate, const std::function<bool()>& is_over);

}  // namespace packmerger
