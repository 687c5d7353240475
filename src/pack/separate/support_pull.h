// How the support of a tray changes as its parts move.
#pragma once

#include <vector>

#include "pack/separate/shape.h"

namespace packmerger {

struct SupportPull {
  double support_mm3 = 0;    // V_s
  Eigen::VectorXd gradient;  // mm³ per mm; six a part, as in Overlap
};

// Counted on the lines of a grid with the given step (maps/columns.h), the derivatives too: on
// every line the voids that need support lie between two facets, whose planes move with their
// parts. Poses are of the shapes' own frames.
SupportPull support_pull(const std::vector<const Shape*>& shapes, const std::vector<Pose>& poses,
                         double step_mm, double support_angle);

}  // namespace packmerger
