// Downhill on an energy of all poses at once.
#pragma once

#include <functional>
#include <vector>

#include "pack/separate/overlap_energy.h"

namespace packmerger {

// Of the poses, which are those of the start moved by `by` (overlap_energy.h).
using PoseEnergy =
    std::function<Overlap(const std::vector<Pose>& poses, const Eigen::VectorXd& by)>;

struct Steps {
  double first = 0.01;    // of the gradient, while no curvature is known
  double longest_mm = 1;  // that a part moves in one
};

// Moves the poses with L-BFGS while goes_on says so and the energy falls. Returns what it came to.
Overlap descend(const std::vector<const Shape*>& shapes, std::vector<Pose>& poses,
                const PoseEnergy& energy, const Steps& steps,
                const std::function<bool(int taken, const Overlap& here)>& goes_on);

}  // namespace packmerger
